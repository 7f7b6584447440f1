// A rolling band's layers that are got ready before the first drag.
#include <gtest/gtest.h>

#include "core/reslice/rolling_band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/stacked_layers.h"

namespace sonoband {
namespace {

// Sets a flag once it has run so many bodies.
class StopsAfter final : public Parallel {
 public:
  StopsAfter(int bodies, StopFlag& stop) : left_(bodies), stop_(stop) {}
  int width() const override { return 1; }
  void for_each(int count, const std::function<void(int)>& body) override {
    for (int i = 0; i < count; ++i) {
      body(i);
      if (--left_ == 0) stop_ = true;
    }
  }

 private:
  int left_;
  StopFlag& stop_;
};

// A scene of many strips: seven across and four down.
test::RandomScene wide_scene(unsigned seed) {
  test::RandomScene scene = test::random_scene(seed);
  scene.plane.width = 840;
  scene.plane.height = 200;
  scene.plane.pixel_mm /= 8;
  scene.settings.compounding = Compounding::maximum;
  scene.settings.interpolation = Interpolation::nearest;
  scene.settings.band.thickness_mm = 10 * scene.settings.band.step_mm;
  return scene;
}

TEST(RollingBand, LayersGotReadyAreThoseOfADragAndCostItNothing) {
  for (unsigned seed = 3380; seed < 3386; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    const bool doppler = sweep.view().frames.front()->bscan.kind == PixelKind::doppler;
    scene.settings.compounding = static_cast<Compounding>(seed % (doppler ? 2 : 3));
    scene.settings.band.thickness_mm = 10 * scene.settings.band.step_mm;
    const ReslicePlane anchor = scene.plane;
    RollingBand rolling;
    EXPECT_EQ(rolling.layers_missing(sweep, anchor, scene.settings), std::nullopt);
    EXPECT_TRUE(rolling.prepare(sweep, anchor, scene.settings, serial));
    const int painted = rolling.layers_painted();
    EXPECT_EQ(painted, 4 * RollingBand::block_layers)
        << "layers -5 to 5 in two blocks, and one on either side";
    for (const int middle : {0, 3, -4, 0}) {
      scene.plane.origin = anchor.origin + (middle * scene.settings.band.step_mm) * anchor.normal();
      EXPECT_EQ(rolling.layers_missing(sweep, scene.plane, scene.settings), 0);
      const BandImage image = rolling.render(sweep, scene.plane, scene.settings, serial);
      ASSERT_TRUE(test::same_bits(image, test::stacked(sweep, anchor, scene.settings, middle)))
          << "seed " << seed << ", middle " << middle;
    }
    EXPECT_LE(rolling.bytes(), RollingBand::most_bytes(anchor, scene.settings));
    // Of at most 11 + 2 (8 + 8) + 2 x 15 = 73 layers: two bytes and two bits of a pixel each; two blocks and
    // 16 runs to spare, counts and sums.
    const std::size_t pixels = static_cast<std::size_t>(anchor.width) * anchor.height;
    EXPECT_LE(RollingBand::most_bytes(anchor, scene.settings),
              pixels * (73 * 17 / 8 + 2 + 2 * 18 + 16 + 16 + 6));
    rolling.clear();
    EXPECT_EQ(rolling.bytes(), 0U);
    EXPECT_EQ(rolling.layers_missing(sweep, anchor, scene.settings), std::nullopt);
  }
}

TEST(RollingBand, GettingReadyEndsWhenToldAndGoesOnFromThere) {
  test::RandomScene scene = wide_scene(3390);
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  RollingBand whole, pieces;
  ASSERT_TRUE(whole.prepare(sweep, scene.plane, scene.settings, serial));
  int turns = 0;
  for (bool ready = false; !ready; ++turns) {
    ASSERT_LT(turns, 100) << "nothing that was painted is kept";
    StopFlag stop{false};
    StopsAfter parallel(3, stop);
    ready = pieces.prepare(sweep, scene.plane, scene.settings, parallel, &stop);
    if (turns == 0) {
      EXPECT_FALSE(ready);
      EXPECT_GT(*pieces.layers_missing(sweep, scene.plane, scene.settings), 0);
    }
    // Half of the way through the plane moves on and comes back.
    if (turns == 3) {
      ReslicePlane on = scene.plane;
      on.origin = on.origin + (3 * scene.settings.band.step_mm) * on.normal();
      EXPECT_TRUE(test::same_bits(pieces.render(sweep, on, scene.settings, serial),
                                  whole.render(sweep, on, scene.settings, serial)));
    }
  }
  EXPECT_GT(turns, 5);
  EXPECT_EQ(pieces.layers_missing(sweep, scene.plane, scene.settings), 0);
  EXPECT_TRUE(test::same_bits(pieces.render(sweep, scene.plane, scene.settings, serial),
                              whole.render(sweep, scene.plane, scene.settings, serial)));
}

}  // namespace
}  // namespace sonoband
