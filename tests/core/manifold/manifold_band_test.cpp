// The unrolled band: a straight curve is a plane bit for bit, a bent one follows what it is drawn along.
#include "core/manifold/manifold_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/manifold/shapes.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr double pixel = 0.5;

// 40 frames of 80 x 60 pixels of 0.5 mm, 0.6 mm apart along z, filled from a formula of the world; x from -20
// to 20, y from 0 to 30, z from 0 to 24 mm.
test::TestSweep sweep_of(const std::function<std::uint8_t(const Eigen::Vector3d&)>& value) {
  test::TestSweep sweep;
  for (int i = 0; i < 40; ++i)
    sweep.add(80, 60, test::image_pose(Eigen::Matrix3d::Identity(), {-20, 0, 0.6 * i}, pixel),
              [&](int, int, const Eigen::Vector3d& p) { return value(p); });
  return sweep;
}

std::uint8_t speckle(const Eigen::Vector3d& p) {
  const double wave = std::sin(3.1 * p.x()) + std::sin(2.3 * p.y() + 1) + std::sin(4.7 * p.z() + p.x());
  return static_cast<std::uint8_t>(128 + 40 * wave);
}

// Lateral-axial plane in the middle of the sweep: its normal is the sweep's direction.
ReslicePlane middle_plane() {
  return {{{-20, 0, 12}}, {Eigen::Vector3d::UnitX()}, {Eigen::Vector3d::UnitY()}, 80, 60, pixel};
}

ManifoldSettings settings_of(double thickness, Compounding compounding = Compounding::maximum) {
  ManifoldSettings settings;
  settings.reach_mm = 8;
  settings.render.band = {thickness, pixel};
  settings.render.compounding = compounding;
  return settings;
}

Curve arc_curve() {
  std::vector<PlanePoint> points;
  for (int i = 0; i <= 40; ++i) {
    const double a = M_PI * i / 40;
    points.emplace_back(20 + 14 * std::cos(a), 6 + 14 * std::sin(a));
  }
  return make_curve(points, {.pixel_mm = pixel}).curve;
}

bool same(const BandImage& a, const BandImage& b) {
  if (a.pixels.width() != b.pixels.width() || a.pixels.height() != b.pixels.height()) return false;
  for (int y = 0; y < a.pixels.height(); ++y)
    for (int x = 0; x < a.pixels.width(); ++x)
      if (a.pixels.view()(x, y) != b.pixels.view()(x, y) ||
          a.coverage.view()(x, y) != b.coverage.view()(x, y))
        return false;
  return true;
}

TEST(ManifoldBand, StraightCurveIsThePlaneBitForBit) {
  const test::TestSweep sweep = sweep_of(speckle);
  std::mt19937_64 random(5);
  Serial serial;
  for (int round = 0; round < 12; ++round) {
    const Eigen::Matrix3d axes = test::random_rotation(random);
    const ReslicePlane plane{{axes * Eigen::Vector3d(-7, -9, 1) + Eigen::Vector3d(0, 15, 12)},
                             {axes.col(0)},
                             {axes.col(1)},
                             40,
                             40,
                             pixel};
    ManifoldSettings settings = settings_of(round % 3 * 3.0);
    settings.render.compounding = static_cast<Compounding>(round % 3);
    settings.render.interpolation = round % 2 == 0 ? Interpolation::nearest : Interpolation::linear;
    settings.flow = static_cast<FlowMethod>(round % 3);
    // Along (0.6, 0.8), 20 mm: 41 rows; given by more points than it needs, and smoothed.
    const Curve curve =
        make_curve(std::vector<PlanePoint>{{1, 2}, {4, 6}, {4.6, 6.8}, {13, 18}}, {.pixel_mm = pixel}).curve;
    const ManifoldBand band = render_manifold(sweep.view(), plane, curve, settings, serial);

    ReslicePlane along;
    along.right = plane.normal();
    const PlanePoint e = (curve.vertices[1] - curve.vertices[0]).normalized();
    along.down = {e.x() * plane.right.v + e.y() * plane.down.v};
    along.origin = {plane.origin.v - 16 * pixel * plane.normal().v + 1.0 * plane.right.v +
                    2.0 * plane.down.v};
    along.width = 33;
    along.height = 41;
    along.pixel_mm = pixel;
    EXPECT_TRUE(same(band.image, render_planar(sweep.view(), along, settings.render, serial))) << round;
    // Some of it is in the sweep.
    int covered = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 33; ++x) covered += band.image.coverage.view()(x, y) != 0;
    EXPECT_GT(covered, 100) << round;
    EXPECT_EQ(std::count(band.smeared.begin(), band.smeared.end(), 255), 0);
  }
}

// The same lines by the arithmetic of bent curves: nothing but rounding between them.
TEST(ManifoldBand, BentArithmeticAgreesWithThePlaneOnALine) {
  Serial serial;
  const ReslicePlane plane = middle_plane();
  const Curve line = test::open_curve({{3, 4}, {15, 20}});
  const Curve with_vertex = test::open_curve({{3, 4}, {9, 12}, {15, 20}});
  const Band band{4, pixel};
  const auto bundle = [&](const Curve& c) {
    return manifold_lines(plane, c, band_flow(c, plane, band, FlowMethod::exact, serial), 8, band);
  };
  const LineBundle a = bundle(line), b = bundle(with_vertex);
  ASSERT_EQ(a.starts.size(), b.starts.size());
  EXPECT_EQ(a.samples, 33);
  EXPECT_EQ(a.rows, 41);
  EXPECT_EQ(a.layers, 9);
  EXPECT_TRUE(b.present.empty());
  for (std::size_t i = 0; i < a.starts.size(); ++i) EXPECT_LT((a.starts[i].v - b.starts[i].v).norm(), 1e-12);
}

// Figure 8: the ruling of every row and layer, from the flow.
TEST(Figure8, RulingsStandOnTheFlowedCurves) {
  Serial serial;
  const ReslicePlane plane = middle_plane();
  const Curve curve = arc_curve();
  const Band band{4, pixel};
  const CurveFlow flow = band_flow(curve, plane, band, FlowMethod::exact, serial);
  const LineBundle lines = manifold_lines(plane, curve, flow, 8, band);
  EXPECT_EQ(lines.rows, static_cast<int>(std::floor(length_mm(curve) / pixel + 0.5)) + 1);
  EXPECT_EQ(lines.step.v, Eigen::Vector3d(0, 0, pixel));
  for (int row = 0; row < lines.rows; ++row)
    for (int k = -4; k <= 4; ++k) {
      const Eigen::Vector3d start = lines.starts[row * 9 + k + 4].v;
      EXPECT_NEAR(start.z(), 12 - 8, 1e-12);
      const PlanePoint foot(start.x() + 20, start.y());
      EXPECT_NEAR(test::distance_to_curve(foot, curve), std::abs(k) * pixel, 0.01 * pixel);
    }
}

TEST(ManifoldBand, ThinBandPaintsTheSurface) {
  // Bright along the arc x^2 + (y - 6)^2 = 14^2 (plane x 20 is world x 0), striped along z.
  const test::TestSweep sweep = sweep_of([](const Eigen::Vector3d& p) {
    const bool on_arc = std::abs(std::hypot(p.x(), p.y() - 6) - 14) < 1.2;
    return static_cast<std::uint8_t>(on_arc ? 100 + 5 * p.z() : 10);
  });
  Serial serial;
  const ManifoldBand band =
      render_manifold(sweep.view(), middle_plane(), arc_curve(), settings_of(0), serial);
  for (int row = 0; row < band.image.pixels.height(); ++row)
    for (int x = 0; x < band.image.pixels.width(); ++x) {
      ASSERT_EQ(band.image.coverage.view()(x, row), 1);
      // Column x is z = 4 + x / 2, shown from a frame within 0.3 mm.
      ASSERT_NEAR(band.image.pixels.view()(x, row), 100 + 5 * (4 + x * pixel), 2.5) << x << " " << row;
    }
}

// Figure 12: what the surface misses by 2 mm appears in the band that is 5 mm thick.
TEST(Figure12, ThickBandShowsWhatTheSurfaceMisses) {
  const test::TestSweep sweep = sweep_of([](const Eigen::Vector3d& p) {
    const double r = std::hypot(p.x(), p.y() - 6);
    return static_cast<std::uint8_t>(std::abs(r - 16) < 0.6 ? 200 : 10);
  });
  Serial serial;
  const auto at_middle = [&](double thickness) {
    const ManifoldBand band =
        render_manifold(sweep.view(), middle_plane(), arc_curve(), settings_of(thickness), serial);
    return band.image.pixels.view()(16, band.image.pixels.height() / 2);
  };
  EXPECT_EQ(at_middle(0), 10);
  EXPECT_EQ(at_middle(5), 200);
}

TEST(ManifoldBand, ThicknessIsMonotoneAndCompoundingsAreOrdered) {
  const test::TestSweep sweep = sweep_of(speckle);
  Serial serial;
  const auto paint = [&](double thickness, Compounding compounding) {
    return render_manifold(sweep.view(), middle_plane(), arc_curve(), settings_of(thickness, compounding),
                           serial)
        .image;
  };
  for (const double thickness : {0.0, 2.0, 5.0, 9.0}) {
    const BandImage high = paint(thickness, Compounding::maximum),
                    low = paint(thickness, Compounding::minimum);
    const BandImage mean = paint(thickness, Compounding::mean);
    const BandImage thicker_high = paint(thickness + 2, Compounding::maximum);
    const BandImage thicker_low = paint(thickness + 2, Compounding::minimum);
    for (int y = 0; y < high.pixels.height(); ++y)
      for (int x = 0; x < high.pixels.width(); ++x) {
        if (high.coverage.view()(x, y) == 0) continue;
        ASSERT_LE(low.pixels.view()(x, y), mean.pixels.view()(x, y));
        ASSERT_LE(mean.pixels.view()(x, y), high.pixels.view()(x, y));
        ASSERT_GE(thicker_high.pixels.view()(x, y), high.pixels.view()(x, y));
        ASSERT_LE(thicker_low.pixels.view()(x, y), low.pixels.view()(x, y));
      }
  }
}

TEST(ManifoldBand, ConstantVolumeIsAConstantPicture) {
  const test::TestSweep sweep = sweep_of([](const Eigen::Vector3d&) { return std::uint8_t{77}; });
  Serial serial;
  for (const Compounding c : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
    const ManifoldBand band =
        render_manifold(sweep.view(), middle_plane(), arc_curve(), settings_of(6, c), serial);
    for (int y = 0; y < band.image.pixels.height(); ++y)
      for (int x = 0; x < band.image.pixels.width(); ++x)
        ASSERT_EQ(band.image.pixels.view()(x, y), band.image.coverage.view()(x, y) != 0 ? 77 : 0);
  }
}

TEST(ManifoldBand, OrderOfFramesDoesNotMatter) {
  test::TestSweep sweep = sweep_of(speckle);
  Serial serial;
  const ManifoldBand a = render_manifold(sweep.view(), middle_plane(), arc_curve(), settings_of(5), serial);
  std::vector<int> order(40);
  for (int i = 0; i < 40; ++i) order[i] = (7 * i + 3) % 40;
  const ManifoldBand b =
      render_manifold(sweep.view(order), middle_plane(), arc_curve(), settings_of(5), serial);
  EXPECT_TRUE(same(a.image, b.image));
}

// Inside a hairpin narrower than the band, layers beyond half its width do not exist: coverage says so.
TEST(ManifoldBand, VanishedFrontsAreNoData) {
  const test::TestSweep sweep = sweep_of(speckle);
  Serial serial;
  std::vector<PlanePoint> points{{5, 12}};
  for (int i = 0; i <= 20; ++i) {
    const double a = -M_PI / 2 + M_PI * i / 20;
    points.emplace_back(30 + 2 * std::cos(a), 14 + 2 * std::sin(a));
  }
  points.emplace_back(5, 16);
  const Curve hairpin = test::open_curve(points);
  const ManifoldBand band = render_manifold(sweep.view(), middle_plane(), hairpin, settings_of(6), serial);
  // 13 layers: 6 outside, the surface, 4 inside (up to 2 mm; the bend's corners end the fourth).
  for (int row = 5; row < 40; ++row) EXPECT_LE(band.image.coverage.view()(16, row), 6 + 1 + 4) << row;
  for (int row = 5; row < 40; ++row) EXPECT_GE(band.image.coverage.view()(16, row), 6 + 1 + 3) << row;
}

TEST(ManifoldBand, SmearMaskCountsTwoKCotThetaRows) {
  Serial serial;
  for (const double between : {60.0, 90.0, 120.0}) {
    const Curve v = test::v_curve(between, 40);
    const CurveFlow flow =
        flow_curve(v, {.step_mm = 0.2, .layers = 18, .ruling_mm = 0.2, .fronts = Fronts::none}, serial);
    for (const int k : {3, 9, 18}) {
      const auto mask = smeared_rows(flow, k);
      const double expected = 2 * k / std::tan(between / 2 * M_PI / 180);
      EXPECT_NEAR(static_cast<double>(std::count(mask.begin(), mask.end(), 255)), expected, 1.001)
          << between << " " << k;
    }
  }
}

TEST(ManifoldBand, ExtremeCurvesAreTheOutermostFronts) {
  const test::TestSweep sweep = sweep_of(speckle);
  Serial serial;
  const Curve curve = arc_curve();
  const ManifoldBand band = render_manifold(sweep.view(), middle_plane(), curve, settings_of(6), serial);
  for (const auto* lines : {&band.up, &band.down}) {
    ASSERT_FALSE(lines->empty());
    for (const PlaneLine& line : *lines)
      for (const PlanePoint& p : line) EXPECT_NEAR(test::distance_to_curve(p, curve), 3, 0.01);
  }
  // c_u lies on the side of n x e: inside this arc, which turns from +x over +y to -x.
  EXPECT_LT((band.up[0][band.up[0].size() / 2] - PlanePoint(20, 6)).norm(), 14);
  EXPECT_GT((band.down[0][band.down[0].size() / 2] - PlanePoint(20, 6)).norm(), 14);
}

TEST(ManifoldBand, AThinnerBandMayUseAThickersFlow) {
  Serial serial;
  const ReslicePlane plane = middle_plane();
  const Curve curve = arc_curve();
  const Band thick{8, pixel}, thin{3, pixel};
  const CurveFlow flow = band_flow(curve, plane, thick, FlowMethod::exact, serial);
  const LineBundle a = manifold_lines(plane, curve, flow, 8, thin);
  const LineBundle b =
      manifold_lines(plane, curve, band_flow(curve, plane, thin, FlowMethod::exact, serial), 8, thin);
  ASSERT_EQ(a.starts.size(), b.starts.size());
  for (std::size_t i = 0; i < a.starts.size(); ++i) EXPECT_EQ(a.starts[i].v, b.starts[i].v);
}

}  // namespace
}  // namespace sonoband
