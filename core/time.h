// The one clock of the house: CLOCK_MONOTONIC in nanoseconds. `core` only carries stamps; `hal` and `app`
// read the clock.
#pragma once

#include <chrono>

namespace sonoband {

// Clock tag without now(): time is always an argument in core (house rule 1).
struct Monotonic {
  using rep = std::chrono::nanoseconds::rep;
  using period = std::chrono::nanoseconds::period;
  using duration = std::chrono::nanoseconds;
  using time_point = std::chrono::time_point<Monotonic>;
  static constexpr bool is_steady = true;
};

using Duration = Monotonic::duration;
using Stamp = Monotonic::time_point;

inline double seconds(Duration d) {
  return std::chrono::duration<double>(d).count();
}
inline double seconds(Stamp t) {
  return seconds(t.time_since_epoch());
}
inline Duration from_seconds(double s) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(s));
}

}  // namespace sonoband
