// The shares of pixels that equal the definition's, as they are promised, over random legal geometry:
// crossing frames, several sweeps, fans, masks, gaps, odd sizes, planes at any angle, grey and Doppler.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/reslice/band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/reference.h"

namespace sonoband {
namespace {

struct Shares {
  test::Difference sum;
  int beyond_ties = 0;  // of nearest extremes

  void add(const test::RandomScene& scene, bool judge_ties) {
    Serial serial;
    const SweepView view = scene.sweep.view();
    const BandImage image = render_planar(view, scene.plane, scene.settings, serial);
    const test::Difference d =
        test::compare(image, test::reference_planar(view, scene.plane, scene.settings));
    sum.pixels += d.pixels;
    sum.unequal += d.unequal;
    sum.beyond_one_level += d.beyond_one_level;
    if (judge_ties && d.unequal > 0)
      beyond_ties += test::beyond_ties(view, scene.plane, scene.settings, image);
  }
};

constexpr unsigned first_seed = 100, last_seed = 140;

TEST(PromisedShares, ThinNearestIsEqualInThreeNines) {
  Shares shares;
  for (unsigned seed = first_seed; seed < last_seed; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    scene.settings.band.thickness_mm = 0;
    scene.settings.compounding = Compounding::maximum;
    shares.add(scene, true);
  }
  EXPECT_GE(shares.sum.equal_share(), 0.999) << shares.sum.unequal << " of " << shares.sum.pixels;
  EXPECT_EQ(shares.beyond_ties, 0);
}

// 14 mm of 0.2 mm: with so many samples to a pixel a tie is more likely among them.
TEST(PromisedShares, NearestMaximumOf71LayersIsEqualIn995OfAThousand) {
  Shares shares;
  for (unsigned seed = first_seed; seed < first_seed + 20; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    scene.settings.band.thickness_mm = 70 * scene.settings.band.step_mm;
    ASSERT_EQ(scene.settings.band.layers(), 71);
    scene.settings.compounding = Compounding::maximum;
    scene.plane.height = std::min(scene.plane.height, 12);
    shares.add(scene, true);
  }
  EXPECT_GT(shares.sum.pixels, 5000);
  EXPECT_GE(shares.sum.equal_share(), 0.995) << shares.sum.unequal << " of " << shares.sum.pixels;
  EXPECT_EQ(shares.beyond_ties, 0);
}

TEST(PromisedShares, MeanIsWithinALevelInThreeNines) {
  for (const Interpolation how : {Interpolation::nearest, Interpolation::linear}) {
    Shares shares;
    for (unsigned seed = first_seed; seed < last_seed; ++seed) {
      test::RandomScene scene = test::random_scene(seed);
      scene.settings.compounding = Compounding::mean;
      scene.settings.interpolation = how;
      shares.add(scene, false);
    }
    EXPECT_GE(shares.sum.close_share(), 0.999) << shares.sum.beyond_one_level << " of " << shares.sum.pixels;
  }
}

TEST(PromisedShares, LinearIsWithinALevelInThreeNines) {
  Shares shares;
  for (unsigned seed = first_seed; seed < last_seed; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    scene.settings.compounding = seed % 2 == 0 ? Compounding::maximum : Compounding::minimum;
    scene.settings.interpolation = Interpolation::linear;
    shares.add(scene, false);
  }
  EXPECT_GE(shares.sum.close_share(), 0.999) << shares.sum.beyond_one_level << " of " << shares.sum.pixels;
}

}  // namespace
}  // namespace sonoband
