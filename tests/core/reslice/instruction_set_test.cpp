// Every instruction set this machine has paints the same picture.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/rolling_band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/only_target.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/support/support.h"

namespace sonoband {
namespace {

// A band, the same one dragged on by two layers, and thinned.
std::array<BandImage, 3> pictures(const test::RandomScene& scene) {
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  RollingBand rolling;
  ReslicePlane plane = scene.plane;
  BandImage still = rolling.render(sweep, plane, scene.settings, serial);
  plane.origin = plane.origin + (2 * scene.settings.band.step_mm) * plane.normal();
  RenderSettings thinned = scene.settings;
  thinned.thin_dense_frames = true;
  return {std::move(still), rolling.render(sweep, plane, scene.settings, serial),
          render_planar(sweep, plane, thinned, serial)};
}

// Shares of equal pixels over scenes, of the best set and of one other.
struct Shares {
  test::Difference nearest, linear;

  void add(test::RandomScene& scene, std::int64_t target) {
    for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
      scene.settings.interpolation = interpolation;
      const std::array<BandImage, 3> best = pictures(scene);
      const test::OnlyTarget only(target);
      ASSERT_EQ(patch_kernels().target, target);
      const std::array<BandImage, 3> images = pictures(scene);
      test::Difference& sum = interpolation == Interpolation::nearest ? nearest : linear;
      for (int i = 0; i < 3; ++i) {
        const test::Difference d = test::compare(best[i], images[i]);
        sum.pixels += d.pixels;
        sum.unequal += d.unequal;
      }
    }
  }
  void expect_equal(std::int64_t target) const {
    EXPECT_GE(nearest.equal_share(), 0.999) << hwy::TargetName(target) << ": " << nearest.unequal;
    EXPECT_GE(linear.equal_share(), 0.999) << hwy::TargetName(target) << ": " << linear.unequal;
  }
};

// Found with Highway 1.2, which has sets of its own for later processors: these went without.
TEST(InstructionSets, WithBytePermutesAreTakenWhereTheProcessorHasThem) {
  EXPECT_EQ(patch_kernels().take_cell != nullptr, (hwy::SupportedTargets() & HWY_AVX3_DL) != 0)
      << hwy::TargetName(patch_kernels().target);
}

TEST(InstructionSets, PaintTheSamePicture) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    Shares shares;
    for (unsigned seed = 4000; seed < 4024; ++seed) {
      test::RandomScene scene = test::random_scene(seed);
      shares.add(scene, target);
    }
    shares.expect_equal(target);
  }
}

// 4000 frames 0.025 mm apart, an eighth of a pixel, with a hand's smooth wobble.
TEST(InstructionSets, PaintTheSamePictureOfADenseSweep) {
  constexpr double pixel_mm = 0.2, spacing_mm = 0.025;
  test::RandomScene scene;
  std::mt19937_64 random(11);
  for (int i = 0; i < 4000; ++i) {
    const double z = spacing_mm * i;
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.05 * std::sin(0.08 * z), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.05 * std::sin(0.11 * z + 1), Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    scene.sweep.add(40, 30, test::image_pose(axes, {0, 0, z}, pixel_mm),
                    [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
  scene.settings.band = {1, pixel_mm};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    Shares shares;
    for (const double turn_deg : {0.0, 30.0, 90.0}) {
      const Eigen::Matrix3d axes = (Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitZ()))
                                       .toRotationMatrix();
      const Eigen::Vector3d middle(4, 3, 50);
      scene.plane = *make_plane(middle - 4.0 * axes.col(0) - 5.0 * axes.col(1), axes.col(0), axes.col(1), 41,
                                51, pixel_mm);
      shares.add(scene, target);
    }
    shares.expect_equal(target);
  }
}

}  // namespace
}  // namespace sonoband
