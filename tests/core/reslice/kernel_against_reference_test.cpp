// Every kernel against the definition, on random legal geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/reslice/band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/reference.h"
#include "tests/support/support.h"

namespace sonoband {
namespace {

constexpr double tie_px_of_kernel = 1e-4;  // a foot may err by so much
constexpr double tie_mm_of_kernel = 1e-4;

class RandomScene : public testing::TestWithParam<unsigned> {};

TEST_P(RandomScene, NearestEqualsReferenceButForTies) {
  test::RandomScene scene = test::random_scene(GetParam());
  const SweepView view = scene.sweep.view();
  const LineBundle bundle = plane_lines(scene.plane, scene.settings.band);
  Serial serial;
  const BandImage image = render_planar(view, scene.plane, scene.settings, serial);
  const BandImage truth = test::reference_planar(view, scene.plane, scene.settings);
  EXPECT_EQ(image.kind, truth.kind);
  const test::Difference d = test::compare(image, truth);
  EXPECT_GE(d.equal_share(), 0.995) << d.unequal << " of " << d.pixels;
  if (truth.kind == PixelKind::doppler && scene.settings.compounding == Compounding::mean) {
    for (int y = 0; y < scene.plane.height; ++y) {
      for (int x = 0; x < scene.plane.width; ++x) {
        const int value = image.pixels.view()(x, y), covered = image.coverage.view()(x, y);
        if (value == truth.pixels.view()(x, y) && covered == truth.coverage.view()(x, y)) continue;
        const auto tied = test::reference_tied_means(view, bundle, scene.settings.gap, x, y, tie_px_of_kernel,
                                                     tie_mm_of_kernel);
        ASSERT_TRUE(tied.contains({value, covered}))
            << "pixel " << x << "," << y << ": " << value << " in " << covered << " layers is no tie";
      }
    }
    return;
  }
  const test::TieRange ties =
      test::reference_ties(view, bundle, scene.settings, tie_px_of_kernel, tie_mm_of_kernel);
  for (int y = 0; y < scene.plane.height; ++y) {
    for (int x = 0; x < scene.plane.width; ++x) {
      const int value = image.pixels.view()(x, y), covered = image.coverage.view()(x, y);
      ASSERT_TRUE(value >= ties.lowest.view()(x, y) && value <= ties.highest.view()(x, y) &&
                  covered >= ties.least_coverage.view()(x, y) && covered <= ties.most_coverage.view()(x, y))
          << "pixel " << x << "," << y << ": " << value << " in " << covered << " layers, truth "
          << int{truth.pixels.view()(x, y)} << " in " << truth.coverage.view()(x, y);
    }
  }
}

TEST_P(RandomScene, LinearIsWithinOneLevelOfReference) {
  test::RandomScene scene = test::random_scene(GetParam());
  scene.settings.interpolation = Interpolation::linear;
  Serial serial;
  const BandImage image = render_planar(scene.sweep.view(), scene.plane, scene.settings, serial);
  const BandImage truth = test::reference_planar(scene.sweep.view(), scene.plane, scene.settings);
  const test::Difference d = test::compare(image, truth);
  EXPECT_GE(d.close_share(), 0.995) << d.beyond_one_level << " of " << d.pixels;
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomScene, testing::Range(1U, 41U));

// Pictures wider than a permute's table, whose edges the lanes run over on every side, with and without a
// mask.
TEST(KernelAgainstReference, WidePicturesBlendUpToTheirEdges) {
  constexpr int width = 200, height = 150;
  constexpr double pixel_mm = 0.2;
  Serial serial;
  for (const bool masked : {false, true}) {
    test::TestSweep sweep;
    std::mt19937_64 random(9);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Matrix3d axes =
          Eigen::AngleAxisd(0.02 * i, Eigen::Vector3d(1, 0.5, 0.2).normalized()).toRotationMatrix();
      sweep.add(width, height, test::image_pose(axes, {0, 0, 0.6 * i}, pixel_mm),
                [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
    }
    if (masked) sweep.set_mask(test::sector_mask(width, height));
    for (const double turn_deg : {0.0, 3.0, 45.0, 90.0, 100.0, 180.0}) {
      for (const double tilt_deg : {0.0, 60.0, 90.0}) {
        const Eigen::Matrix3d axes = (Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(tilt_deg * M_PI / 180, Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
        const Eigen::Vector3d middle(20, 15, 1.5);
        RenderSettings settings;
        settings.band = {0.8, pixel_mm};
        settings.interpolation = Interpolation::linear;
        const ReslicePlane plane = *make_plane(middle - 22.0 * axes.col(0) - 3.0 * axes.col(1), axes.col(0),
                                               axes.col(1), 220, 30, pixel_mm);
        const test::Difference d = test::compare(render_planar(sweep.view(), plane, settings, serial),
                                                 test::reference_planar(sweep.view(), plane, settings));
        EXPECT_EQ(d.beyond_one_level, 0) << "turned by " << turn_deg << ", tilted by " << tilt_deg;
      }
    }
  }
}

// Frames fanned so that their gaps differ across a tile a little, much, and from one frame to the next.
TEST(KernelAgainstReference, FansBlendByTheirGaps) {
  constexpr double pixel_mm = 0.2;
  Serial serial;
  for (const double fan_deg : {0.05, 0.3, 0.8, 2.0}) {
    test::TestSweep sweep;
    std::mt19937_64 random(5);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Matrix3d axes =
          Eigen::AngleAxisd((fan_deg * i + 0.1 * fan_deg * (i % 3)) * M_PI / 180, Eigen::Vector3d::UnitX())
              .toRotationMatrix();
      sweep.add(150, 90, test::image_pose(axes, {0, 0, 0.4 * i}, pixel_mm),
                [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
    }
    for (const double turn_deg : {0.0, 40.0, 90.0}) {
      const Eigen::Matrix3d axes = (Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
      const Eigen::Vector3d middle(15, 6, 8);
      RenderSettings settings;
      settings.band = {3, pixel_mm};
      settings.interpolation = Interpolation::linear;
      const ReslicePlane plane = *make_plane(middle - 8.0 * axes.col(0) - 7.0 * axes.col(1), axes.col(0),
                                             axes.col(1), 80, 70, pixel_mm);
      const test::Difference d = test::compare(render_planar(sweep.view(), plane, settings, serial),
                                               test::reference_planar(sweep.view(), plane, settings));
      EXPECT_EQ(d.beyond_one_level, 0) << "fan of " << fan_deg << ", turned by " << turn_deg;
    }
  }
}

}  // namespace
}  // namespace sonoband
