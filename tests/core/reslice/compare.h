// Comparing a kernel's picture with the reference's.
#pragma once

#include <cstdlib>

#include "core/reslice/band.h"

namespace sonoband::test {

struct Difference {
  int pixels = 0;            // compared
  int unequal = 0;           // value or coverage
  int beyond_one_level = 0;  // values differ by more than 1
  double equal_share() const { return pixels > 0 ? 1.0 - static_cast<double>(unequal) / pixels : 1.0; }
  double close_share() const {
    return pixels > 0 ? 1.0 - static_cast<double>(beyond_one_level) / pixels : 1.0;
  }
};

inline Difference compare(const BandImage& a, const BandImage& b) {
  Difference d;
  for (int y = 0; y < a.pixels.height(); ++y) {
    for (int x = 0; x < a.pixels.width(); ++x) {
      const int difference = std::abs(a.pixels.view()(x, y) - b.pixels.view()(x, y));
      const bool covered = a.coverage.view()(x, y) == b.coverage.view()(x, y);
      ++d.pixels;
      d.unequal += difference != 0 || !covered ? 1 : 0;
      d.beyond_one_level += difference > 1 ? 1 : 0;
    }
  }
  return d;
}

inline bool same_bits(const BandImage& a, const BandImage& b) {
  return a.pixels.width() == b.pixels.width() && a.pixels.height() == b.pixels.height() &&
         compare(a, b).unequal == 0;
}

}  // namespace sonoband::test
