// Planar bands of phantoms whose pictures are known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reslice/band.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

using test::image_pose;
using test::TestSweep;

constexpr double pixel = 0.25;  // mm; a power of two, so that positions are exact

// Parallel frames `spacing_mm` apart along z, pixels in World's x and y, of 64x48 pixels from the origin.
TestSweep stack(int frames, double spacing_mm, const TestSweep::PixelFormula& value) {
  TestSweep sweep;
  for (int i = 0; i < frames; ++i)
    sweep.add(64, 48, image_pose(Eigen::Matrix3d::Identity(), {0, 0, i * spacing_mm}, pixel), value);
  return sweep;
}

// Cuts all frames: right along x, down along the sweep, at depth `y_mm`; its normal is -y.
ReslicePlane c_plane(double y_mm, int width = 64, int height = 41) {
  return *make_plane({0, y_mm, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), width, height, pixel);
}

BandImage render(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings) {
  Serial serial;
  return render_planar(sweep, plane, settings, serial);
}

RenderSettings thick(double mm, Compounding compounding = Compounding::maximum) {
  RenderSettings settings;
  settings.band = {mm, pixel};
  settings.compounding = compounding;
  return settings;
}

TEST(PlanarBand, RampReadsTheColumn) {
  const TestSweep sweep =
      stack(21, 0.5, [](int x, int, const auto&) { return static_cast<std::uint8_t>(3 * x); });
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    RenderSettings settings = thick(0);
    settings.interpolation = interpolation;
    const BandImage image = render(sweep.view(), c_plane(3.0), settings);
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 64; ++x) ASSERT_EQ(image.pixels.view()(x, y), 3 * x) << x << "," << y;
  }
}

TEST(PlanarBand, LinearBlendsAcrossTheGapByDistance) {
  // Frame i has the value 40 i everywhere; rows are half a spacing apart, so odd rows lie half-way.
  const TestSweep sweep =
      stack(6, 0.5, [](int, int, const Eigen::Vector3d& p) { return static_cast<std::uint8_t>(80 * p.z()); });
  RenderSettings settings = thick(0);
  settings.interpolation = Interpolation::linear;
  const BandImage image = render(sweep.view(), c_plane(3.0, 64, 11), settings);
  for (int y = 0; y < 11; ++y) ASSERT_EQ(image.pixels.view()(10, y), 20 * y);
}

TEST(PlanarBand, HalfWayBetweenFramesTheLaterWins) {
  const TestSweep sweep =
      stack(6, 0.5, [](int, int, const Eigen::Vector3d& p) { return static_cast<std::uint8_t>(80 * p.z()); });
  const BandImage image = render(sweep.view(), c_plane(3.0, 64, 11), thick(0));
  for (int y = 0; y < 11; ++y) ASSERT_EQ(image.pixels.view()(10, y), 40 * ((y + 1) / 2));
}

TEST(PlanarBand, ConstantStaysConstantAndNoDataIsNotBlack) {
  const TestSweep sweep = stack(9, 0.5, [](int, int, const auto&) { return std::uint8_t{77}; });
  // 64 pixels of 0.25 mm across, 4 mm along the sweep; the plane reaches beyond on all sides.
  const ReslicePlane plane =
      *make_plane({-2, 3, -2}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), 100, 40, pixel);
  for (const auto how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
    const BandImage image = render(sweep.view(), plane, thick(2, how));
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 100; ++x) {
        const double z = -2 + pixel * y;
        const bool inside = x >= 8 && x < 72 && z >= -0.25 && z <= 4.25;
        ASSERT_EQ(image.coverage.view()(x, y), inside ? 9 : 0) << x << "," << y;
        ASSERT_EQ(image.pixels.view()(x, y), inside ? 77 : 0);
      }
    }
  }
}

TEST(PlanarBand, BlackTissueIsCovered) {
  const TestSweep sweep = stack(9, 0.5, [](int, int, const auto&) { return std::uint8_t{0}; });
  const BandImage image = render(sweep.view(), c_plane(3.0, 64, 17), thick(1));
  EXPECT_EQ(image.coverage.view()(5, 5), 5);
  EXPECT_EQ(image.pixels.view()(5, 5), 0);
}

// A wire along the sweep at depth row 24 is one bright pixel row; the band of N layers about depth y0
// contains it exactly while |row of the wire - row of the plane| <= (N - 1) / 2.
TEST(PlanarBand, WireIsInOrOutAsTheLayerFormulaSays) {
  const TestSweep sweep =
      stack(21, 0.5, [](int, int y, const auto&) { return static_cast<std::uint8_t>(y == 24 ? 250 : 10); });
  for (const double thickness : {0.0, 0.5, 1.0, 1.2, 1.25, 1.3, 3.0}) {
    const Band band{thickness, pixel};
    const int half = (band.layers() - 1) / 2;
    EXPECT_EQ(half, static_cast<int>(std::floor(thickness / (2 * pixel) + 0.5)));
    for (int row = 10; row < 40; ++row) {
      const BandImage image = render(sweep.view(), c_plane(row * pixel, 8, 9), thick(thickness));
      const int expected = std::abs(row - 24) <= half ? 250 : 10;
      ASSERT_EQ(image.pixels.view()(3, 4), expected) << "thickness " << thickness << ", row " << row;
    }
  }
}

TEST(PlanarBand, SphereThroughAThickBandIsItsFullDisc) {
  const Eigen::Vector3d centre(8, 6, 5);
  const double radius = 3;
  const TestSweep sweep = stack(21, 0.5, [&](int, int, const Eigen::Vector3d& p) {
    return static_cast<std::uint8_t>((p - centre).norm() <= radius ? 200 : 20);
  });
  // 1 mm above the middle: thin shows a disc of sqrt(8) mm, a band of 4 mm reaches the middle and shows 3 mm.
  for (const double thickness : {0.0, 4.0}) {
    const BandImage image = render(sweep.view(), c_plane(centre.y() - 1), thick(thickness));
    const double expected = thickness == 0 ? std::sqrt(radius * radius - 1) : radius;
    for (int y = 2; y < 39; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double r = std::hypot(pixel * x - centre.x(), pixel * y - centre.z());
        if (std::abs(r - expected) < 0.5) continue;  // half a frame spacing, half a pixel
        ASSERT_EQ(image.pixels.view()(x, y), r < expected ? 200 : 20) << x << "," << y;
      }
    }
  }
}

TEST(PlanarBand, CalibrationErrorMovesTheWireWithItsSign) {
  // The wire is at World depth 6 mm. A calibration 1 mm too deep puts every picture, and the wire, 1 mm
  // deeper.
  for (const double error_mm : {-1.0, 0.0, 1.0}) {
    TestSweep sweep;
    for (int i = 0; i < 11; ++i) {
      sweep.add(64, 48, image_pose(Eigen::Matrix3d::Identity(), {0, error_mm, i * 0.5}, pixel),
                [](int, int y, const auto&) { return static_cast<std::uint8_t>(y * pixel == 6 ? 250 : 0); });
    }
    // Longitudinal: right along the sweep, down in depth.
    const ReslicePlane plane =
        *make_plane({4, 0, 0}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 20, 60, pixel);
    const BandImage image = render(sweep.view(), plane, thick(0));
    const int row = static_cast<int>((6 + error_mm) / pixel);
    for (int y = 0; y < 48; ++y) ASSERT_EQ(image.pixels.view()(10, y), y == row ? 250 : 0) << error_mm;
  }
}

TEST(PlanarBand, NoFramesAndNoPixels) {
  const BandImage empty = render({}, c_plane(3), thick(2));
  EXPECT_EQ(empty.pixels.width(), 64);
  EXPECT_EQ(empty.coverage.view()(5, 5), 0);
  const TestSweep sweep = stack(3, 0.5, [](int, int, const auto&) { return std::uint8_t{9}; });
  EXPECT_EQ(render(sweep.view(), c_plane(3, 0, 0), thick(2)).pixels.width(), 0);
  const BandImage far = render(sweep.view(), c_plane(500), thick(2));
  EXPECT_EQ(far.coverage.view()(5, 5), 0);
}

TEST(PlanarBand, PlaneOnOneFrameGivesItsPicture) {
  const TestSweep sweep =
      stack(1, 0.5, [](int x, int y, const auto&) { return static_cast<std::uint8_t>(3 * x + 5 * y); });
  const ReslicePlane plane =
      *make_plane({0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 64, 48, pixel);
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    RenderSettings settings = thick(0);
    settings.interpolation = interpolation;
    const BandImage image = render(sweep.view(), plane, settings);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        ASSERT_EQ(image.pixels.view()(x, y), static_cast<std::uint8_t>(3 * x + 5 * y));
  }
}

TEST(PlanarBand, GapStaysOpenUnlessTheLimitReachesAcross) {
  TestSweep sweep = stack(20, 0.25, [](int, int, const auto&) { return std::uint8_t{50}; });
  // A jump of 5 mm, then on.
  for (int i = 0; i < 20; ++i) {
    sweep.add(64, 48, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 9.75 + 0.25 * i}, pixel),
              [](int, int, const auto&) { return std::uint8_t{60}; });
  }
  RenderSettings settings = thick(0);
  const BandImage open = render(sweep.view(), c_plane(3), settings);
  EXPECT_EQ(open.coverage.view()(3, 19), 1);
  EXPECT_EQ(open.coverage.view()(3, 30), 0);  // 7.5 mm, in the jump
  EXPECT_EQ(open.coverage.view()(3, 39), 1);
  settings.gap.mm = 2.5;
  const BandImage closed = render(sweep.view(), c_plane(3), settings);
  for (int y = 0; y < 41; ++y) ASSERT_EQ(closed.coverage.view()(3, y), 1);
}

TEST(GapLimits, HalfTheLargestCornerDistanceAndNeverAcrossAJump) {
  TestSweep sweep;
  for (const double z : {0.0, 0.5, 1.0, 1.5, 1.5, 1.5, 9.0})
    sweep.add(8, 8, image_pose(Eigen::Matrix3d::Identity(), {0, 0, z}, pixel),
              [](int, int, const auto&) { return std::uint8_t{1}; });
  const std::vector<double> d = gap_limits(sweep.view(), {});
  EXPECT_DOUBLE_EQ(d[0], 0.25);
  EXPECT_DOUBLE_EQ(d[3], 0.25);
  EXPECT_DOUBLE_EQ(d[4], pixel / 2);  // held still: half a pixel
  EXPECT_DOUBLE_EQ(d[6], 0.25);       // alone beyond a jump: half the median
  EXPECT_EQ(gap_limits(sweep.view(), {0.7}), std::vector<double>(7, 0.7));
}

TEST(PlanarBand, ThinningLeavesFramesAtMostAPixelApart) {
  // 0.05 mm apart; a pixel of 0.25 mm holds 5 gaps.
  const TestSweep sweep = stack(
      41, 0.05, [](int, int, const Eigen::Vector3d& p) { return static_cast<std::uint8_t>(100 * p.z()); });
  const std::vector<const TrackedFrame*> kept = thinned(sweep.view(), pixel);
  ASSERT_EQ(kept.size(), 9U);
  EXPECT_EQ(kept.back(), sweep.view().frames.back());
  for (std::size_t i = 1; i < kept.size(); ++i) {
    EXPECT_LE(kept[i]->world_from_image.translation.z() - kept[i - 1]->world_from_image.translation.z(),
              pixel + 1e-9);
  }
  RenderSettings settings = thick(0);
  settings.thin_dense_frames = true;
  const BandImage image = render(sweep.view(), c_plane(3.0, 64, 8), settings);
  EXPECT_EQ(image.frames_left_out, 32);
  for (int y = 0; y < 8; ++y) {
    EXPECT_EQ(image.coverage.view()(5, y), 1);
    // Half a pixel beyond what the definition, with all frames, may be off: half a gap.
    EXPECT_NEAR(image.pixels.view()(5, y), 100 * pixel * y, 100 * (pixel + 0.05) / 2 + 1);
  }
  EXPECT_EQ(render(sweep.view(), c_plane(3.0, 64, 8), thick(0)).frames_left_out, 0);
}

}  // namespace
}  // namespace sonoband
