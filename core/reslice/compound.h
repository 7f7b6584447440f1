// Compounding the layers of one pixel, sample by sample.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/image/doppler.h"
#include "core/reslice/band.h"

namespace sonoband {

// Rounded once, halves up.
constexpr std::uint8_t rounded_mean(std::uint32_t sum, std::uint32_t count) {
  return static_cast<std::uint8_t>((2 * sum + count) / (2 * count));
}

// 1 / (2 count) for rounded means without dividing: exact for counts of a byte and sums of so many bytes.
struct MeanInverses {
  std::uint64_t inverse[256];
  constexpr MeanInverses() : inverse() {
    for (std::uint64_t count = 1; count < 256; ++count)
      inverse[count] = ((std::uint64_t{1} << 40) + 2 * count - 1) / (2 * count);
  }
  constexpr std::uint8_t mean(std::uint32_t sum, std::uint8_t count) const {
    return static_cast<std::uint8_t>(((2 * sum + count) * inverse[count]) >> 40);
  }
};
inline constexpr MeanInverses mean_inverses;

// Halves away from zero.
constexpr int rounded_signed_mean(int sum, int count) {
  return sum >= 0 ? (2 * sum + count) / (2 * count) : -((-2 * sum + count) / (2 * count));
}

// The mean by core/image/doppler.h; of a grey picture coloured is 0 throughout.
struct MeanSums {
  std::uint32_t grey = 0;      // sum of the grey samples
  std::uint32_t greys = 0;     // how many
  std::uint32_t coloured = 0;  // how many
  int velocity = 0;            // sum of the coloured samples, levels

  void add(std::uint8_t key, PixelKind kind) {
    if (kind == PixelKind::doppler && doppler::is_colour(key)) {
      ++coloured;
      velocity += doppler::velocity(key);
    } else {
      ++greys;
      grey += key;
    }
  }

  // The same where all counts fit a byte, without dividing.
  std::uint8_t value_of_few() const {
    const auto few = [](std::uint32_t count) { return static_cast<std::uint8_t>(count); };
    const int mean =
        mean_inverses.mean(static_cast<std::uint32_t>(std::abs(velocity)), few(greys + coloured));
    if (mean != 0) return doppler::velocity_key(velocity < 0 ? -mean : mean);
    return mean_inverses.mean(grey, few(greys));
  }

  std::uint8_t value() const {
    if (coloured > 0) {
      const int mean = rounded_signed_mean(velocity, static_cast<int>(greys + coloured));
      if (mean != 0) return doppler::velocity_key(mean);
    }
    return greys > 0 ? rounded_mean(grey, greys) : 0;
  }
};

}  // namespace sonoband
