// Every instruction set this machine has paints the same picture.
#define HWY_WANT_AVX3_DL 1  // as core/reslice/patch_kernels.cpp is compiled
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "core/reslice/patch.h"
#include "core/reslice/rolling_band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"

namespace sonoband {
namespace {

// Lets only one set be chosen while it lives.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { choose(target); }
  ~OnlyTarget() { choose(0); }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;

 private:
  static void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

// A band and the same one dragged on by two layers.
std::array<BandImage, 2> pictures(const test::RandomScene& scene) {
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  RollingBand rolling;
  ReslicePlane plane = scene.plane;
  BandImage still = rolling.render(sweep, plane, scene.settings, serial);
  plane.origin = plane.origin + (2 * scene.settings.band.step_mm) * plane.normal();
  return {std::move(still), rolling.render(sweep, plane, scene.settings, serial)};
}

TEST(InstructionSets, PaintTheSamePicture) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    test::Difference nearest, linear;
    for (unsigned seed = 4000; seed < 4024; ++seed) {
      test::RandomScene scene = test::random_scene(seed);
      for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
        scene.settings.interpolation = interpolation;
        const std::array<BandImage, 2> best = pictures(scene);
        const OnlyTarget only(target);
        ASSERT_EQ(patch_kernels().target, target);
        const std::array<BandImage, 2> images = pictures(scene);
        test::Difference& sum = interpolation == Interpolation::nearest ? nearest : linear;
        for (int i = 0; i < 2; ++i) {
          const test::Difference d = test::compare(best[i], images[i]);
          sum.pixels += d.pixels;
          sum.unequal += d.unequal;
        }
      }
    }
    EXPECT_GE(nearest.equal_share(), 0.999) << hwy::TargetName(target) << ": " << nearest.unequal;
    EXPECT_GE(linear.equal_share(), 0.999) << hwy::TargetName(target) << ": " << linear.unequal;
  }
}

}  // namespace
}  // namespace sonoband
