// One patch's pixels, gathered from pieces of up to patch_layers layers.
#pragma once

#include <algorithm>
#include <array>

#include "core/reslice/band.h"
#include "core/reslice/compound.h"
#include "core/reslice/patch.h"

namespace sonoband {

inline Rule rule_of(Compounding how, PixelKind kind) {
  switch (how) {
    case Compounding::maximum:
      return Rule::maximum;
    case Compounding::minimum:
      return Rule::minimum;
    case Compounding::mean:
      break;
  }
  return kind == PixelKind::doppler ? Rule::mean_doppler : Rule::mean_grey;
}

class PatchTotals {
 public:
  explicit PatchTotals(Rule rule) : rule_(rule) {}

  void clear() {
    clear_piece();
    pieces_ = 0;
  }
  // What kernels add to; next_piece() before more than patch_layers layers have gone in.
  PatchSums& piece() { return piece_; }
  void next_piece() {
    gather();
    clear_piece();
  }

  // Lane 0 is pixel (x, y); lanes beyond the picture are dropped.
  void store(BandImage& image, int x, int y, LaneShape shape) {
    std::array<std::uint8_t, patch_lanes> values;
    std::array<std::uint16_t, patch_lanes> counts;
    const bool mean = rule_ == Rule::mean_grey || rule_ == Rule::mean_doppler;
    if (pieces_ == 0) {
      for (int k = 0; k < patch_lanes; ++k) counts[k] = piece_.count[k];
      if (!mean) values = piece_.extreme;
      for (int k = 0; mean && k < patch_lanes; ++k) {
        values[k] = rule_ == Rule::mean_grey || piece_.coloured[k] == 0
                        ? mean_inverses.mean(piece_.sum[k], piece_.count[k])
                        : mean_of(k).value();
      }
    } else {
      gather();
      counts = count_;
      for (int k = 0; k < patch_lanes; ++k) values[k] = mean ? means_[k].value() : extreme_[k];
    }
    if (rule_ == Rule::minimum) {
      for (int k = 0; k < patch_lanes; ++k) values[k] = counts[k] != 0 ? values[k] : std::uint8_t{0};
    }
    const int width = std::min(shape.across, image.pixels.width() - x);
    const int height = std::min(shape.down(), image.pixels.height() - y);
    const auto put = [&](auto columns) {
      for (int row = 0; row < height; ++row) {
        std::copy_n(values.data() + row * shape.across, columns(), image.pixels.view().row(y + row) + x);
        std::copy_n(counts.data() + row * shape.across, columns(), image.coverage.view().row(y + row) + x);
      }
    };
    // Rows of a known length are stored without a call.
    if (width == 8) {
      put([] { return 8; });
    } else if (width == 16) {
      put([] { return 16; });
    } else {
      put([&] { return width; });
    }
  }

 private:
  void gather() {
    for (int k = 0; k < patch_lanes; ++k) {
      const MeanSums more = mean_of(k);
      if (pieces_ == 0) {
        extreme_[k] = piece_.extreme[k];
        count_[k] = piece_.count[k];
        means_[k] = more;
        continue;
      }
      extreme_[k] = rule_ == Rule::minimum ? std::min(extreme_[k], piece_.extreme[k])
                                           : std::max(extreme_[k], piece_.extreme[k]);
      count_[k] = static_cast<std::uint16_t>(count_[k] + piece_.count[k]);
      means_[k].grey += more.grey;
      means_[k].greys += more.greys;
      means_[k].coloured += more.coloured;
      means_[k].velocity += more.velocity;
    }
    ++pieces_;
  }
  MeanSums mean_of(int k) const {
    const std::uint32_t coloured = rule_ == Rule::mean_doppler ? piece_.coloured[k] : 0;
    return {piece_.sum[k], piece_.count[k] - coloured, coloured,
            rule_ == Rule::mean_doppler ? piece_.velocity[k] : 0};
  }
  void clear_piece() {
    piece_.extreme.fill(rule_ == Rule::minimum ? 255 : 0);
    piece_.count.fill(0);
    piece_.coloured.fill(0);
    piece_.sum.fill(0);
    piece_.velocity.fill(0);
  }

  Rule rule_;
  int pieces_ = 0;
  PatchSums piece_{};
  std::array<std::uint8_t, patch_lanes> extreme_{};
  std::array<std::uint16_t, patch_lanes> count_{};
  std::array<MeanSums, patch_lanes> means_{};
};

}  // namespace sonoband
