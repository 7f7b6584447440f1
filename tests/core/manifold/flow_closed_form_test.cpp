// Curve flow against closed forms: the line, the circle and the V, and its symmetries.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/manifold/flow.h"
#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

CurveFlow flow(const Curve& curve, int layers, Fronts fronts = Fronts::none,
               FlowMethod method = FlowMethod::exact) {
  Serial serial;
  return flow_curve(
      curve, {.method = method, .step_mm = 1, .layers = layers, .ruling_mm = 1, .fronts = fronts}, serial);
}

TEST(Flow, LineMovesAlongItsNormal) {
  const Curve line = test::open_curve({{1, 2}, {61, 82}});
  const PlanePoint normal(-0.8, 0.6);  // direction (0.6, 0.8), a quarter turn from right towards down
  for (const FlowMethod method : {FlowMethod::exact, FlowMethod::route_map, FlowMethod::naive}) {
    const CurveFlow result = flow(line, 20, Fronts::all, method);
    ASSERT_EQ(result.rulings.size(), 101u);
    for (int k = -20; k <= 20; ++k) {
      for (std::size_t i = 0; i < result.rulings.size(); ++i) {
        const PlanePoint p(1 + 0.6 * i, 2 + 0.8 * i);
        EXPECT_LT((result.rulings[i].at - p).norm(), 1e-9);
        ASSERT_TRUE(result.layer(k).feet[i]);
        EXPECT_LT((*result.layer(k).feet[i] - (p + k * normal)).norm(), 1e-9);
      }
      ASSERT_EQ(result.layer(k).front.size(), 1u);
      EXPECT_LT((result.layer(k).front[0].front() - (PlanePoint(1, 2) + k * normal)).norm(), 1e-9);
      EXPECT_LT((result.layer(k).front[0].back() - (PlanePoint(61, 82) + k * normal)).norm(), 1e-9);
    }
  }
}

// Down the picture with columns along the normal: the layers follow right x down of that picture.
TEST(Flow, PositiveLayersLieOnTheSideOfTheNormalCrossTheDirection) {
  const Curve down = test::open_curve({{0, 0}, {0, 10}});
  const CurveFlow result = flow(down, 1);
  // n x e with n = z and e = y is -x.
  EXPECT_LT((*result.layer(1).feet[0] - PlanePoint(-1, 0)).norm(), 1e-12);
  EXPECT_LT((*result.layer(-1).feet[0] - PlanePoint(1, 0)).norm(), 1e-12);
}

TEST(Flow, CircleShrinksToItsCentreAndGrows) {
  const double radius = 20;
  const int corners = 400;
  // Fine corners: apothem and radius differ by 6e-4.
  const Curve ring = test::circle(radius, corners);
  const CurveFlow result = flow(ring, 30, Fronts::all);
  for (int k = 1; k <= 30; ++k) {
    // From +x towards +y the quarter turn of the direction points inwards.
    for (const auto& foot : result.layer(-k).feet) {
      ASSERT_TRUE(foot);
      EXPECT_NEAR(foot->norm(), radius + k, 1e-3);
    }
    for (const auto& foot : result.layer(k).feet) {
      ASSERT_EQ(foot.has_value(), k < radius) << k;
      EXPECT_NEAR(foot ? foot->norm() : radius - k, radius - k, 1e-3);
    }
    EXPECT_EQ(result.layer(k).front.empty(), k >= radius) << k;
    // Closed: the first point comes again at the end.
    ASSERT_EQ(result.layer(-k).front.size(), 1u);
    const PlaneLine& outer = result.layer(-k).front[0];
    EXPECT_EQ(outer.front(), outer.back());
  }
}

// th is half the angle between the arms: the shock lies at k / sin th on the bisector, and exactly the
// rulings within k cot th of the corner are smeared onto it, on each arm.
TEST(Flow, VSmearsTwoKCotThetaRows) {
  for (const FlowMethod method : {FlowMethod::exact, FlowMethod::route_map})
    for (const double between : {30.0, 60.0, 90.0, 120.0, 150.0}) {
      const double th = between / 2 * M_PI / 180;
      const Curve v = test::v_curve(between, 200);
      const CurveFlow result = flow(v, 36, Fronts::none, method);
      for (int k = 1; k <= 36; ++k) {
        const PlanePoint shock(k / std::sin(th), 0);
        int smeared = 0;
        // The curve comes from +y and leaves to -y, turning towards +x: the quarter turn of its direction.
        for (std::size_t i = 0; i < result.rulings.size(); ++i) {
          const double from_corner = std::abs(static_cast<double>(i) - 200);
          const auto& foot = result.layer(k).feet[i];
          ASSERT_TRUE(foot);
          const bool at_shock = (*foot - shock).norm() < 1e-6;
          smeared += at_shock;
          EXPECT_EQ(at_shock, from_corner <= k / std::tan(th) + 1e-9) << between << " " << k << " " << i;
          // On the outer side every ruling has a place of its own.
          ASSERT_TRUE(result.layer(-k).feet[i]);
          if (i == 0) continue;
          EXPECT_GT((*result.layer(-k).feet[i] - *result.layer(-k).feet[i - 1]).norm(), 0.9)
              << between << " " << k << " " << i;
        }
        EXPECT_NEAR(smeared, 2 * k / std::tan(th), 1) << between << " " << k;
      }
    }
}

TEST(Flow, OuterSideOfACornerIsAnArc) {
  const CurveFlow result = flow(test::v_curve(90, 100), 20, Fronts::outermost);
  double last_angle = 0;
  int on_arc = 0;
  ASSERT_EQ(result.layer(-20).front.size(), 1u);
  for (const PlanePoint& p : result.layer(-20).front[0]) {
    if (p.x() > -20 * std::sqrt(0.5) + 1e-9) continue;
    EXPECT_NEAR(p.norm(), 20, 1e-9);
    const double angle = std::atan2(-p.y(), -p.x());
    EXPECT_TRUE(on_arc == 0 || angle > last_angle);
    ++on_arc;
    last_angle = angle;
  }
  EXPECT_GT(on_arc, 20);
}

// A ruling on a corner is as near to all of its arc: it takes the middle.
TEST(Flow, ARulingOnACornerTakesTheMiddleOfItsArc) {
  for (const double between : {30.0, 90.0, 150.0}) {
    const CurveFlow result = flow(test::v_curve(between, 100), 36);
    for (int k = 1; k <= 36; ++k) {
      ASSERT_TRUE(result.layer(-k).feet[100]);
      EXPECT_LT((*result.layer(-k).feet[100] - PlanePoint(-k, 0)).norm(), 1e-9) << between << " " << k;
    }
  }
}

// A spike's tip stands 8 above the middle of a floor. Layer 6 of the floor ends where it is 6 from the tip,
// at sqrt(32) on either side; the ruling in the middle is as far from both ends and takes the earlier.
TEST(Flow, OfEquallyNearPointsTheEarlierAlongTheCurveIsTaken) {
  const double side = std::hypot(0.5, 22), last = 234 - 80 - 30 - 39.5 - 2 * side;  // 234 mm in all
  const Curve spike =
      test::open_curve({{-40, 0}, {40, 0}, {40, 30}, {0.5, 30}, {0, 8}, {-0.5, 30}, {-0.5 - last, 30}});
  for (const bool back : {false, true}) {
    const CurveFlow result = flow(back ? test::reversed(spike) : spike, 6);
    const int middle = back ? 234 - 40 : 40;
    ASSERT_LT(result.rulings[middle].at.norm(), 1e-9);
    const auto& foot = result.layer(back ? -6 : 6).feet[middle];
    ASSERT_TRUE(foot);
    EXPECT_LT((*foot - PlanePoint((back ? 1 : -1) * std::sqrt(32), 6)).norm(), 1e-9) << back;
  }
}

struct Motion {
  double angle;
  PlanePoint shift;
  PlanePoint operator*(const PlanePoint& p) const {
    return {std::cos(angle) * p.x() - std::sin(angle) * p.y() + shift.x(),
            std::sin(angle) * p.x() + std::cos(angle) * p.y() + shift.y()};
  }
};

class Symmetry : public testing::TestWithParam<test::Shape> {};
INSTANTIATE_TEST_SUITE_P(Flow, Symmetry, testing::ValuesIn(test::all_shapes()),
                         [](const auto& shape) { return shape.param.name; });

// Share of rulings whose feet differ by more than 1e-6; rulings at equal distance from two parts of a front
// may take either after rounding, and so may the rulings behind them.
double share_changed(const CurveFlow& a, const CurveFlow& b, const Motion& motion) {
  int changed = 0, all = 0;
  for (std::size_t l = 0; l < a.layers.size(); ++l)
    for (std::size_t i = 0; i < a.rulings.size(); ++i) {
      const auto& p = a.layers[l].feet[i];
      const auto& q = b.layers[l].feet[i];
      ++all;
      changed += p.has_value() != q.has_value() || (p && (motion * *p - *q).norm() > 1e-6);
    }
  return static_cast<double>(changed) / all;
}

// A ruling in the middle between two parts of a symmetric front, in every layer. Where the curve runs back
// along itself, both passes' rulings are.
double allowed(const test::Shape& shape) {
  return shape.name == "back_along_itself" || shape.name == "needle" ? 0.01 : 0.002;
}

TEST_P(Symmetry, ReversalSwapsTheSides) {
  const Curve& curve = GetParam().curve;
  const CurveFlow forth = flow(curve, 36);
  CurveFlow back = flow(test::reversed(curve), 36);
  ASSERT_EQ(forth.rulings.size(), back.rulings.size());
  std::reverse(back.layers.begin(), back.layers.end());
  for (FlowLayer& layer : back.layers) std::reverse(layer.feet.begin(), layer.feet.end());
  EXPECT_LE(share_changed(forth, back, {0, {0, 0}}), allowed(GetParam()));
}

TEST_P(Symmetry, RigidMotionMovesEverythingWithIt) {
  const Motion motion{0.7, {310, -120}};
  Curve moved = GetParam().curve;
  for (PlanePoint& v : moved.vertices) v = motion * v;
  EXPECT_LE(share_changed(flow(GetParam().curve, 36), flow(moved, 36), motion), allowed(GetParam()));
}

TEST_P(Symmetry, MoreVerticesOnTheSameEdgesChangeNothing) {
  const Curve& curve = GetParam().curve;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.1, 0.9);
  Curve split{{}, curve.closed};
  for (int e = 0; e < curve.edges(); ++e) {
    const double s = share(random);
    split.vertices.push_back(curve.edge_start(e));
    split.vertices.push_back((1 - s) * curve.edge_start(e) + s * curve.edge_end(e));
  }
  if (!curve.closed) split.vertices.push_back(curve.vertices.back());
  EXPECT_LE(share_changed(flow(curve, 36), flow(split, 36), {0, {0, 0}}), allowed(GetParam()));
}

TEST_P(Symmetry, SameBitsForAnyOrderOfTasks) {
  // Runs tasks backwards: what two threads could do to each other's order.
  class Backwards final : public Parallel {
   public:
    int width() const override { return 2; }
    void for_each(int count, const std::function<void(int)>& body) override {
      for (int i = count; i-- > 0;) body(i);
    }
  };
  Backwards backwards;
  const FlowSettings settings{.step_mm = 1, .layers = 12, .ruling_mm = 1, .fronts = Fronts::all};
  const CurveFlow a = flow(GetParam().curve, 12, Fronts::all);
  const CurveFlow b = flow_curve(GetParam().curve, settings, backwards);
  for (std::size_t l = 0; l < a.layers.size(); ++l) {
    EXPECT_EQ(a.layers[l].feet, b.layers[l].feet);
    EXPECT_EQ(a.layers[l].front, b.layers[l].front);
  }
}

// The step is only a unit: layer 3 at 0.4 mm is layer 12 at 0.1 mm.
TEST(Flow, StepIsAUnit) {
  Serial serial;
  const Curve curve = test::gentle_shapes().back().curve;
  const CurveFlow coarse = flow_curve(curve, {.step_mm = 4, .layers = 3, .ruling_mm = 1}, serial);
  const CurveFlow fine = flow_curve(curve, {.step_mm = 1, .layers = 12, .ruling_mm = 1}, serial);
  for (const int k : {-3, -2, -1, 1, 2, 3})
    for (std::size_t i = 0; i < coarse.rulings.size(); ++i)
      EXPECT_LT((*coarse.layer(k).feet[i] - *fine.layer(4 * k).feet[i]).norm(), 1e-6) << k << " " << i;
}

}  // namespace
}  // namespace sonoband
