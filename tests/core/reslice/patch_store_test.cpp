// What a patch stores: the lanes that its tile has, and nothing of the tile beside it.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/reslice/patch_totals.h"
#include "core/reslice/tile.h"
#include "tests/core/reslice/reference.h"
#include "tests/support/speed_sweep.h"

namespace sonoband {
namespace {

constexpr int width = 150, height = 140;  // room for a patch on every side
constexpr int x = 70, y = 66;             // where the tile begins
constexpr std::uint8_t others = 250;      // what is there before, of other tiles

// Lane k has the value k, in k + 1 layers.
PatchTotals numbered_lanes() {
  PatchTotals totals(Rule::maximum);
  totals.clear();
  for (int k = 0; k < patch_lanes; ++k) {
    totals.piece().extreme[k] = static_cast<std::uint8_t>(k);
    totals.piece().count[k] = static_cast<std::uint16_t>(k + 1);
  }
  return totals;
}

BandImage of_other_tiles() {
  BandImage image{Pixels(width, height), ImageBuffer<std::uint16_t>(width, height), PixelKind::grey};
  std::fill_n(image.pixels.view().data, width * height, others);
  std::fill_n(image.coverage.view().data, width * height, std::uint16_t{others});
  return image;
}

// Rectangles and sheared patches, whole and partly outside, in tiles smaller than a patch.
TEST(PatchStore, KeepsToTheLanesThatATileSmallerThanThePatchHas) {
  for (int across = 1; across <= patch_lanes; across *= 2) {
    for (const LaneShape shape :
         {LaneShape{across}, LaneShape{across, 0.7, 0}, LaneShape{across, 0, -0.45}}) {
      const LaneGrid grid = lane_grid(shape);
      for (const auto& [tile_width, tile_height] : {std::pair{1, 1}, {5, 3}, {32, 2}, {3, 40}, {64, 64}}) {
        for (const int da : {0, -across}) {
          BandImage image = of_other_tiles();
          numbered_lanes().store(image, x + da, y, grid,
                                 existing_lanes(grid, da, 0, tile_width, tile_height));
          BandImage expected = of_other_tiles();
          for (int k = 0; k < patch_lanes; ++k) {
            const int a = da + shape.a(k), b = shape.b(k);
            if (a < 0 || b < 0 || a >= tile_width || b >= tile_height) continue;
            expected.pixels.view()(x + a, y + b) = static_cast<std::uint8_t>(k);
            expected.coverage.view()(x + a, y + b) = static_cast<std::uint16_t>(k + 1);
          }
          const int pixels = width * height;
          EXPECT_TRUE(std::equal(image.pixels.view().data, image.pixels.view().data + pixels,
                                 expected.pixels.view().data) &&
                      std::equal(image.coverage.view().data, image.coverage.view().data + pixels,
                                 expected.coverage.view().data))
              << across << " across, sheared by " << shape.rows_per_sample << ", " << shape.samples_per_row
              << ", tile of " << tile_width << "x" << tile_height << " from " << da;
        }
      }
    }
  }
}

// Pictures whose last tiles are a few pixels wide and high, painted from the last to the first.
TEST(PatchStore, ATileOfAFewPixelsLeavesTheTileBeforeItAlone) {
  class Backwards final : public Parallel {
   public:
    int width() const override { return 2; }
    void for_each(int count, const std::function<void(int)>& body) override {
      for (int i = count; i-- > 0;) body(i);
    }
  };
  test::SpeedSweepOptions options;
  options.frames = 30;
  options.width = 180;
  options.height = 150;
  options.length_mm = 15;
  const test::TestSweep sweep = test::speed_sweep(options);
  Backwards backwards;
  for (const auto& [columns, rows] : {std::pair{131, 35}, {35, 131}, {67, 66}}) {
    for (const Compounding how : {Compounding::maximum, Compounding::minimum}) {
      for (const ReslicePlane& plane : test::random_planes(4, 9, columns, rows, 0.2)) {
        ReslicePlane near = plane;  // the sweep's own middle
        near.origin.v += Eigen::Vector3d(0, 15, 7.5) - Eigen::Vector3d(0, 48, 50);
        RenderSettings settings;
        settings.band = {0.8, 0.2};
        settings.compounding = how;
        const BandImage image = render_planar(sweep.view(), near, settings, backwards);
        EXPECT_EQ(test::beyond_ties(sweep.view(), near, settings, image), 0) << columns << "x" << rows;
        const auto covered = image.coverage.view();
        EXPECT_GT(std::count_if(covered.data, covered.data + columns * rows, [](int n) { return n > 0; }),
                  columns * rows / 4);
      }
    }
  }
}

}  // namespace
}  // namespace sonoband
