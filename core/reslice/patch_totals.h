// One patch's pixels, gathered from pieces of up to patch_layers layers.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>

#include "core/reslice/band.h"
#include "core/reslice/compound.h"
#include "core/reslice/layer_block.h"
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
    const LanesAt at{x, y, image.pixels.width(), image.pixels.height(), shape};
    put_lanes(values.data(), at, [&](int row) { return image.pixels.view().row(row); });
    put_lanes(counts.data(), at, [&](int row) { return image.coverage.view().row(row); });
  }

  // Of a single layer.
  void store(LayerBlock& block, int layer, int x, int y, LaneShape shape) {
    std::array<std::uint8_t, patch_lanes> has;
    for (int k = 0; k < patch_lanes; ++k) has[k] = static_cast<std::uint8_t>(-piece_.count[k]);
    put_layer(piece_.extreme, has, block, layer, {x, y, block.width, block.values.height(), shape});
  }
  // Layers 0 .. depth - 1 of a patch as layers `first` and on.
  static void store(const PatchLayers& layers, int depth, LayerBlock& block, int first, int x, int y,
                    LaneShape shape) {
    std::array<std::uint8_t, patch_lanes> has;
    for (int l = 0; l < depth; ++l) {
      const LaneMask lanes = layers.has_data[l];
      // Eight bits to eight bytes of 0 or 255: bit i to the top of byte i.
      for (int i = 0; i < 8; ++i) {
        const std::uint64_t bits = (lanes >> (8 * i) & 0xff) * 0x0101010101010101ULL & 0x8040201008040201ULL;
        const std::uint64_t ones = (bits + 0x7f7f7f7f7f7f7f7fULL) & 0x8080808080808080ULL;
        const std::uint64_t bytes = (ones >> 7) * 0xff;
        std::memcpy(has.data() + 8 * i, &bytes, 8);
      }
      put_layer(layers.values[l], has, block, first + l, {x, y, block.width, block.values.height(), shape});
    }
  }

 private:
  using LaneBytes = std::array<std::uint8_t, patch_lanes>;
  // Where lane 0 is in a picture.
  struct LanesAt {
    int x, y, picture_width, picture_height;
    LaneShape shape;
  };
  static void put_layer(const LaneBytes& values, const LaneBytes& has, LayerBlock& block, int layer,
                        const LanesAt& at) {
    put_lanes(values.data(), at, [&](int row) { return block.values_row(layer, row); });
    put_lanes(has.data(), at, [&](int row) { return block.has_data_row(layer, row); });
  }
  template <class T, class Row>
  static void put_lanes(const T* lanes, const LanesAt& at, Row row_at) {
    const int width = std::min(at.shape.across, at.picture_width - at.x);
    const int height = std::min(at.shape.down(), at.picture_height - at.y);
    const auto put = [&](auto columns) {
      for (int row = 0; row < height; ++row)
        std::copy_n(lanes + row * at.shape.across, columns(), row_at(at.y + row) + at.x);
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
