// How often something happens, from the stamps of the last few times.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/time.h"

namespace sonoband::cart {

class RateMeter {
 public:
  void happened(Stamp t) {
    stamps_[count_ % stamps_.size()] = t;
    ++count_;
  }

  // Intervals per second over the last 32 events, some 1 s of pictures or 0.1 s of poses. 0 until there are
  // two, and after a second of silence.
  double hz(Stamp now) const {
    const std::size_t n = std::min(count_, stamps_.size());
    if (n < 2) return 0;
    const Stamp newest = stamps_[(count_ - 1) % stamps_.size()];
    const Stamp oldest = stamps_[(count_ - n) % stamps_.size()];
    if (now - newest > std::chrono::seconds(1) || newest <= oldest) return 0;
    return static_cast<double>(n - 1) / seconds(newest - oldest);
  }

 private:
  std::array<Stamp, 32> stamps_{};
  std::size_t count_ = 0;
};

}  // namespace sonoband::cart
