// The linear mode's sample: bilinear taps of one or two B-scans, blended by distance. Grey and Doppler, by
// core/reslice/band.h and core/image/doppler.h.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/image/doppler.h"
#include "core/reslice/frame_table.h"

namespace sonoband {

class TapBlend {
 public:
  explicit TapBlend(const FrameTable& table) : table_(table) {}

  // Adds the up to four taps at foot (x, y) with weights that sum to `share`. The foot's own pixel must be in
  // picture and mask, so that there is always one.
  void add(const FrameEntry& f, double x, double y, double share) {
    const double left = std::floor(x), top = std::floor(y);
    const double fx = x - left, fy = y - top;
    const int u = static_cast<int>(left), v = static_cast<int>(top);
    const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    double sum = 0;
    bool taken[4];
    for (int k = 0; k < 4; ++k) {
      const int tx = u + (k & 1), ty = v + (k >> 1);
      taken[k] = tx >= 0 && ty >= 0 && tx < f.width && ty < f.height &&
                 (table_.mask.empty() || table_.mask(tx, ty) != 0);
      if (taken[k]) sum += weights[k];
    }
    for (int k = 0; k < 4; ++k) {
      if (taken[k]) add_tap(f.pixels[(v + (k >> 1)) * f.stride + u + (k & 1)], weights[k] * share / sum);
    }
  }

  std::uint8_t value() const {
    constexpr double noise = 1e-9;  // a sum that should be a half must not fall below it
    if (coloured_ >= 0.5 - noise)
      return doppler::velocity_key(static_cast<int>(std::round(velocity_ / coloured_)));
    return static_cast<std::uint8_t>(grey_ / greys_ + 0.5 + noise);
  }

 private:
  void add_tap(std::uint8_t key, double weight) {
    if (table_.kind == PixelKind::doppler && doppler::is_colour(key)) {
      coloured_ += weight;
      velocity_ += weight * doppler::velocity(key);
    } else {
      greys_ += weight;
      grey_ += weight * key;
    }
  }

  const FrameTable& table_;
  double grey_ = 0, greys_ = 0, velocity_ = 0, coloured_ = 0;
};

}  // namespace sonoband
