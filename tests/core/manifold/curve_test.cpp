// Curves from strokes: what is refused, what is dropped, what stays in place; rulings at equal arc length.
#include "core/manifold/curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/manifold/smooth.h"
#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

CurveFault fault_of(const std::vector<PlanePoint>& stroke, const CurveSettings& settings = {.pixel_mm = 1}) {
  return make_curve(stroke, settings).fault;
}

TEST(Curve, RefusesWhatIsNoCurveAndSaysWhy) {
  EXPECT_EQ(fault_of({}), CurveFault::no_points);
  EXPECT_EQ(fault_of({{1, 2}}), CurveFault::one_point);
  EXPECT_EQ(fault_of({{1, 2}, {1, 2}, {1, 2}}), CurveFault::one_point);
  EXPECT_EQ(fault_of({{0, 0}, {nan_value, 2}}), CurveFault::not_finite);
  EXPECT_EQ(fault_of({{0, 0}, {0, infinite}}), CurveFault::not_finite);
  EXPECT_EQ(fault_of({{0, 0}, {1e300, 0}}), CurveFault::too_long);
  EXPECT_EQ(fault_of({{0, 0}, {70000, 0}}), CurveFault::too_long);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}}, {.pixel_mm = 0}), CurveFault::bad_settings);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}}, {.pixel_mm = nan_value}), CurveFault::bad_settings);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}}, {.smooth_px = -1}), CurveFault::bad_settings);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}}, {.smooth_px = 1e9}), CurveFault::bad_settings);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}, {0, 0}}, {.pixel_mm = 1, .closed = true}), CurveFault::closed_too_few);
  EXPECT_EQ(fault_of({{0, 0}, {9, 0}}), CurveFault::none);
  const CurveResult result = make_curve(std::vector<PlanePoint>{{0, 0}, {1, 1}, {2, nan_value}}, {});
  EXPECT_EQ(result.point, 2u);
  EXPECT_TRUE(result.curve.vertices.empty());
  EXPECT_NE(describe(CurveFault::one_point), describe(CurveFault::no_points));
}

TEST(Curve, WithoutSmoothingPointsStayAsGivenAndRepeatedOnesGo) {
  const std::vector<PlanePoint> given{{0, 0}, {0, 0}, {10, 0}, {10, 5}, {10, 5}, {10, 5}, {0, 7}};
  const Curve curve = make_curve(given, {.pixel_mm = 1, .smooth_px = 0}).curve;
  EXPECT_EQ(curve.vertices, (std::vector<PlanePoint>{{0, 0}, {10, 0}, {10, 5}, {0, 7}}));
  const std::vector<PlanePoint> ring{{0, 0}, {10, 0}, {10, 5}, {0, 0}, {0, 0}};
  EXPECT_EQ(make_curve(ring, {.pixel_mm = 1, .smooth_px = 0, .closed = true}).curve.vertices.size(), 3u);
}

TEST(Curve, StraightHoweverGivenIsItsTwoEnds) {
  const std::vector<PlanePoint> given{{1, 1}, {2, 1.5}, {4, 2.5}, {21, 11}};
  for (const double smooth : {0.0, 4.0, 50.0}) {
    const Curve curve = make_curve(given, {.pixel_mm = 0.2, .smooth_px = smooth}).curve;
    EXPECT_EQ(curve.vertices, (std::vector<PlanePoint>{{1, 1}, {21, 11}})) << smooth;
  }
  // Back along itself is not straight.
  const std::vector<PlanePoint> back{{0, 0}, {10, 0}, {5, 0}, {20, 0}};
  EXPECT_EQ(make_curve(back, {.pixel_mm = 1, .smooth_px = 0}).curve.vertices.size(), 4u);
}

TEST(Curve, SmoothingKeepsTheEndsAndCalmsTheHand) {
  const auto shaky = test::stroke(5, 300, 0.3);
  const Curve curve = make_curve(shaky, {.pixel_mm = 1}).curve;
  EXPECT_EQ(curve.vertices.front(), shaky.front());
  EXPECT_EQ(curve.vertices.back(), shaky.back());
  const auto calm = test::stroke(5, 300, 0);
  // 0.3 mm of jitter every 2 mm; the mean over some ten samples leaves less than 0.4.
  for (const PlanePoint& v : curve.vertices)
    EXPECT_LT(test::distance_to_curve(v, test::open_curve(calm)), 0.4 + 0.3);
  const auto sharpest_turn = [](const Curve& c) {
    double sharpest = 0;
    for (std::size_t i = 2; i < c.vertices.size(); ++i) {
      const PlanePoint a = c.vertices[i - 1] - c.vertices[i - 2], b = c.vertices[i] - c.vertices[i - 1];
      sharpest = std::max(sharpest, std::abs(std::atan2(cross(a, b), a.dot(b))));
    }
    return sharpest;
  };
  EXPECT_GT(sharpest_turn(make_curve(shaky, {.pixel_mm = 1, .smooth_px = 0}).curve), 0.5);
  EXPECT_LT(sharpest_turn(curve), 0.1);
}

// A Gaussian damps a wave of wavelength w to exp(-2 (pi sigma / w)^2) of its height.
TEST(Curve, SmoothingDampsAWaveAsAGaussianDoes) {
  const double wavelength = 40, sigma = 4;
  std::vector<PlanePoint> wave;
  for (int i = 0; i <= 400; ++i) wave.emplace_back(i, 0.1 * std::sin(2 * M_PI * i / wavelength));
  const auto smooth = smooth_along(wave, false, sigma);
  const double left = std::exp(-2 * std::pow(M_PI * sigma / wavelength, 2));
  for (int i = 0; i <= 400; ++i) {
    EXPECT_NEAR(smooth[i].x(), i, 1e-9);
    // Cut off at four sigma: 6e-5 of the weight is missing.
    EXPECT_NEAR(smooth[i].y(), left * wave[i].y(), 1e-4) << i;
  }
}

TEST(Curve, SmoothingAClosedCurveKnowsNoSeam) {
  std::vector<PlanePoint> ring;
  for (int i = 0; i < 90; ++i) {
    const double r = 30 + (i % 7);
    ring.emplace_back(r * std::cos(i * M_PI / 45), r * std::sin(i * M_PI / 45));
  }
  std::vector<PlanePoint> turned = ring;
  std::rotate(turned.begin(), turned.begin() + 33, turned.end());
  auto a = smooth_along(ring, true, 4);
  std::rotate(a.begin(), a.begin() + 33, a.end());
  const auto b = smooth_along(turned, true, 4);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-12);
}

TEST(Curve, ResamplesAtEqualArcLength) {
  const Curve bent = test::open_curve({{0, 0}, {30, 40}, {30, 90}});
  const auto samples = resample(bent, 1);
  ASSERT_EQ(samples.size(), 101u);
  EXPECT_LT((samples[25] - PlanePoint(15, 20)).norm(), 1e-9);
  EXPECT_LT((samples[75] - PlanePoint(30, 65)).norm(), 1e-9);
  EXPECT_EQ(samples.back(), PlanePoint(30, 90));
}

TEST(Curve, RulingsStandAtEqualArcLengthFromEndToEnd) {
  const Curve bent = test::open_curve({{0, 0}, {30, 40}, {30, 90.2}});
  const auto feet = ruling_feet(bent, 1);
  ASSERT_EQ(feet.size(), 101u);  // round(100.2) + 1
  EXPECT_EQ(feet.front().at, PlanePoint(0, 0));
  EXPECT_LT((feet.back().at - PlanePoint(30, 90.2)).norm(), 1e-9);
  EXPECT_LT((feet[75].at - PlanePoint(30, 40 + 75 * 1.002 - 50)).norm(), 1e-9);
  EXPECT_EQ(feet[75].edge, 1);
  EXPECT_NEAR(feet[75].along_mm, 75 * 1.002 - 50, 1e-9);
  // Shorter than half a spacing: one row.
  EXPECT_EQ(ruling_feet(test::open_curve({{0, 0}, {0.3, 0}}), 1).size(), 1u);
  // Closed: back at the start.
  const auto round = ruling_feet(test::closed_curve({{0, 0}, {10, 0}, {10, 10}, {0, 10}}), 1);
  ASSERT_EQ(round.size(), 41u);
  EXPECT_LT((round.back().at - round.front().at).norm(), 1e-9);
}

TEST(Curve, KnowsWhetherItCrossesItself) {
  EXPECT_FALSE(crosses_itself(test::open_curve({{0, 0}, {10, 0}, {10, 10}, {0, 10}})));
  EXPECT_TRUE(crosses_itself(test::open_curve({{0, 0}, {10, 0}, {10, 10}, {5, 10}, {5, -3}})));
  EXPECT_TRUE(crosses_itself(test::open_curve({{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}})));
  EXPECT_FALSE(crosses_itself(test::closed_curve({{0, 0}, {10, 0}, {10, 10}, {0, 10}})));
  EXPECT_FALSE(crosses_itself(test::circle(30, 200)));
  EXPECT_TRUE(crosses_itself(test::closed_curve({{0, 0}, {10, 10}, {10, 0}, {0, 10}})));
  for (const auto& shape : test::hard_shapes()) {
    if (shape.name != "loop" && !shape.name.starts_with("spiral")) continue;
    EXPECT_EQ(crosses_itself(shape.curve), shape.name == "loop") << shape.name;
  }
}

}  // namespace
}  // namespace sonoband
