#include "hal/clock.h"

#include <thread>

namespace sonoband {

Stamp SystemClock::now() {
  return Stamp(std::chrono::steady_clock::now().time_since_epoch());
}

void SystemClock::sleep_until(Stamp t) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(t.time_since_epoch()));
}

}  // namespace sonoband
