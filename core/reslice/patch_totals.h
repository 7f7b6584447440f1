// One patch's pixels, gathered from pieces of up to patch_layers layers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
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
    LaneBytes values;
    LaneCounts counts;
    compound(values, counts);
    const LanesAt at{x, y, image.pixels.width(), image.pixels.height(), shape};
    put_lanes(values.data(), at, [&](int row) { return image.pixels.view().row(row); });
    put_lanes(counts.data(), at, [&](int row) { return image.coverage.view().row(row); });
  }
  // Lanes of any grid; those not in `lanes` are dropped.
  void store(BandImage& image, int x, int y, const LaneGrid& grid, LaneMask lanes) {
    LaneBytes values;
    LaneCounts counts;
    compound(values, counts);
    for (int i = 0; i < grid.run_count; ++i) {
      const LaneRun& run = grid.runs[i];
      const LaneMask of_run = lanes >> run.lane & ~LaneMask{0} >> (patch_lanes - run.count);
      if (of_run == 0) continue;
      // They are beside one another, for what drops them is a rectangle.
      const int skip = std::countr_zero(of_run), count = std::popcount(of_run);
      const int lane = run.lane + skip, column = x + run.a + skip, row = y + run.b;
      std::copy_n(values.data() + lane, count, image.pixels.view().row(row) + column);
      std::copy_n(counts.data() + lane, count, image.coverage.view().row(row) + column);
    }
  }

  // Of a single layer.
  void store(LayerBlock& block, int layer, int x, int y, LaneShape shape) {
    LaneMarks has;
    for (int k = 0; k < patch_lanes; ++k) has[k] = static_cast<std::uint16_t>(piece_.count[k] << layer);
    const LanesAt at{x, y, block.width, block.values.height(), shape};
    put_lanes(piece_.extreme.data(), at, [&](int row) { return block.values_row(layer, row); });
    put_marks(has, LayerBlock::bits(layer, 1), block, at);
  }
  // Layers 0 .. depth - 1 of a patch as layers `first` and on.
  static void store(const PatchLayers& layers, int depth, LayerBlock& block, int first, int x, int y,
                    LaneShape shape) {
    const LanesAt at{x, y, block.width, block.values.height(), shape};
    for (int l = 0; l < depth; ++l)
      put_lanes(layers.values[l].data(), at, [&](int row) { return block.values_row(first + l, row); });
    LaneMarks has = layers.has_data;
    if (first > 0)
      for (std::uint16_t& h : has) h = static_cast<std::uint16_t>(h << first);
    put_marks(has, LayerBlock::bits(first, depth), block, at);
  }

 private:
  using LaneBytes = std::array<std::uint8_t, patch_lanes>;
  using LaneCounts = std::array<std::uint16_t, patch_lanes>;
  using LaneMarks = std::array<std::uint16_t, patch_lanes>;
  // Of all pieces.
  void compound(LaneBytes& values, LaneCounts& counts) {
    const bool mean = rule_ == Rule::mean_grey || rule_ == Rule::mean_doppler;
    if (pieces_ == 0) {
      for (int k = 0; k < patch_lanes; ++k) counts[k] = piece_.count[k];
      if (!mean) values = piece_.extreme;
      for (int k = 0; mean && k < patch_lanes; ++k) {
        values[k] = rule_ == Rule::mean_grey || piece_.coloured[k] == 0
                        ? mean_inverses.mean(piece_.sum[k], piece_.count[k])
                        : mean_of(k).value_of_few();
      }
    } else {
      gather();
      counts = count_;
      for (int k = 0; k < patch_lanes; ++k) values[k] = mean ? means_[k].value() : extreme_[k];
    }
    if (rule_ == Rule::minimum) {
      for (int k = 0; k < patch_lanes; ++k) values[k] = counts[k] != 0 ? values[k] : std::uint8_t{0};
    }
  }
  // Where lane 0 is in a picture.
  struct LanesAt {
    int x, y, picture_width, picture_height;
    LaneShape shape;
  };
  // `has` of the layers whose bits are in `which`; the others' stay.
  static void put_marks(LaneMarks& has, std::uint16_t which, LayerBlock& block, const LanesAt& at) {
    const auto row_at = [&](int row) { return block.has_data.view().row(row); };
    if (which != LayerBlock::bits(0, block.layers)) {
      const int width = std::min(at.shape.across, at.picture_width - at.x);
      const int height = std::min(at.shape.down(), at.picture_height - at.y);
      for (int row = 0; row < height; ++row) {
        for (int i = 0; i < width; ++i) {
          std::uint16_t& h = has[row * at.shape.across + i];
          h = static_cast<std::uint16_t>(h | (row_at(at.y + row)[at.x + i] & ~which));
        }
      }
    }
    put_lanes(has.data(), at, row_at);
  }
  template <class T, class Row>
  static void put_lanes(const T* lanes, const LanesAt& at, Row row_at) {
    const int width = std::min(at.shape.across, at.picture_width - at.x);
    const int height = std::min(at.shape.down(), at.picture_height - at.y);
    const auto put = [&](auto columns) {
      for (int row = 0; row < height; ++row)
        std::memcpy(row_at(at.y + row) + at.x, lanes + row * at.shape.across, columns() * sizeof(T));
    };
    // Rows of a known length are stored without a call.
    switch (width) {
      case 4:
        return put([] { return 4; });
      case 8:
        return put([] { return 8; });
      case 16:
        return put([] { return 16; });
      case 32:
        return put([] { return 32; });
      case 64:
        return put([] { return 64; });
      default:
        return put([&] { return width; });
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
