// The laws of curve flow on every shape, and that the naive strategy of Figure 9b breaks them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/manifold/flow.h"
#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

using test::Shape;

constexpr int last_layer = 36;
constexpr double eps = 0.01;  // of a step
// The brute-force referees look at these layers, on both sides.
const int looked_at[] = {1, 2, 7, 13, 20, 26, 36};

CurveFlow flow(const Curve& curve, FlowMethod method = FlowMethod::exact) {
  Serial serial;
  return flow_curve(
      curve, {.method = method, .step_mm = 1, .layers = last_layer, .ruling_mm = 1, .fronts = Fronts::all},
      serial);
}

std::vector<int> layers() {
  std::vector<int> ks;
  for (const int k : looked_at) {
    ks.push_back(k);
    ks.push_back(-k);
  }
  return ks;
}

// Segments a b and c d cross inside both, away from their ends: lines that meet in a shock share it to 1e-5.
bool cross_properly(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const double across = cross(b - a, d - c);
  if (std::abs(across) < 1e-12) return false;
  const double t = cross(c - a, d - c) / across;
  const double u = cross(c - a, b - a) / across;
  const double slack_t = 1e-5 / (b - a).norm(), slack_u = 1e-5 / (d - c).norm();
  return t > slack_t && t < 1 - slack_t && u > slack_u && u < 1 - slack_u;
}

int crossings(const std::vector<PlaneLine>& lines) {
  std::vector<std::pair<PlanePoint, PlanePoint>> segments;
  for (const PlaneLine& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i) segments.emplace_back(line[i - 1], line[i]);
  int count = 0;
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      const auto& [a, b] = segments[i];
      const auto& [c, d] = segments[j];
      if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()))
        continue;
      count += cross_properly(a, b, c, d);
    }
  return count;
}

// Rulings of layer k whose foot is not at distance k from the curve.
int misplaced(const CurveFlow& flow, const Curve& curve, int k) {
  int count = 0;
  for (const auto& foot : flow.layer(k).feet)
    if (foot) count += std::abs(test::distance_to_curve(*foot, curve) - std::abs(k)) > eps;
  return count;
}

// Route map and naive do not promise these; the counts show that the laws have teeth.
int misplaced_in_all(const Curve& curve, FlowMethod method) {
  const CurveFlow result = flow(curve, method);
  int count = 0;
  for (const int k : layers()) count += misplaced(result, curve, k);
  return count;
}

int crossings_in_all(const Curve& curve, FlowMethod method) {
  const CurveFlow result = flow(curve, method);
  int count = 0;
  for (const int k : layers()) count += crossings(result.layer(k).front);
  return count;
}

class EveryShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Flow, EveryShape, testing::ValuesIn(test::all_shapes()),
                         [](const auto& shape) { return shape.param.name; });

class GentleShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Flow, GentleShape, testing::ValuesIn(test::gentle_shapes()),
                         [](const auto& shape) { return shape.param.name; });

TEST_P(EveryShape, ExactFeetAreAtTheLayersDistance) {
  const Curve& curve = GetParam().curve;
  const CurveFlow exact = flow(curve);
  for (const int k : layers()) {
    EXPECT_EQ(misplaced(exact, curve, k), 0) << "layer " << k;
    for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
      const auto& foot = exact.layer(k).feet[i];
      if (!foot) continue;
      EXPECT_GE((*foot - exact.rulings[i].at).norm(), std::abs(k) - eps) << "layer " << k << " ruling " << i;
    }
  }
}

// Of the edges that are nearest to a foot one has it on the layer's side; before the tip of a curve that
// turns straight back it is on both.
TEST_P(EveryShape, ExactFeetAreOnTheLayersSideOfANearestEdge) {
  const Curve& curve = GetParam().curve;
  const CurveFlow exact = flow(curve);
  for (const int k : layers())
    for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
      const auto& foot = exact.layer(k).feet[i];
      if (!foot) continue;
      bool on_side = false;
      for (int e = 0; e < curve.edges() && !on_side; ++e) {
        const PlanePoint &a = curve.edge_start(e), &b = curve.edge_end(e);
        if (distance_to_segment(*foot, a, b) > std::abs(k) + eps) continue;
        on_side = cross(b - a, *foot - a) * (k > 0 ? 1 : -1) > -1e-6;
      }
      ASSERT_TRUE(on_side) << "layer " << k << " ruling " << i;
    }
}

TEST_P(EveryShape, ExactFrontsAreAtTheLayersDistance) {
  const Curve& curve = GetParam().curve;
  const CurveFlow exact = flow(curve);
  for (const int k : layers())
    for (const PlaneLine& line : exact.layer(k).front)
      for (const PlanePoint& p : line)
        ASSERT_NEAR(test::distance_to_curve(p, curve), std::abs(k), eps) << "layer " << k;
}

TEST_P(EveryShape, ExactFrontsDoNotCrossThemselves) {
  const CurveFlow exact = flow(GetParam().curve);
  for (const int k : layers()) EXPECT_EQ(crossings(exact.layer(k).front), 0) << "layer " << k;
}

TEST_P(EveryShape, ExactFeetLieOnTheFront) {
  const CurveFlow exact = flow(GetParam().curve);
  for (const int k : layers())
    for (const auto& foot : exact.layer(k).feet) {
      if (!foot) continue;
      ASSERT_LT(test::distance_to_lines(*foot, exact.layer(k).front), 0.003) << "layer " << k;
    }
}

// The front, walked line by line, is met in the order of the rulings. Of a closed curve the walk begins where
// the front does, which may lie between any two rulings: it may go round once more.
TEST_P(EveryShape, ExactFeetKeepTheOrderOfTheRulings) {
  const CurveFlow exact = flow(GetParam().curve);
  const int rounds = GetParam().curve.closed ? 2 : 1;
  for (const int k : layers()) {
    std::vector<std::pair<PlanePoint, PlanePoint>> segments;
    for (int round = 0; round < rounds; ++round)
      for (const PlaneLine& line : exact.layer(k).front)
        for (std::size_t i = 1; i < line.size(); ++i) segments.emplace_back(line[i - 1], line[i]);
    std::size_t at = 0;
    double along = 0;
    for (std::size_t r = 0; r < exact.rulings.size(); ++r) {
      const auto& foot = exact.layer(k).feet[r];
      if (!foot) continue;
      bool found = false;
      for (; at < segments.size(); ++at, along = 0) {
        const auto& [a, b] = segments[at];
        if (distance_to_segment(*foot, a, b) > 0.003) continue;
        const double here = (*foot - a).dot(b - a) / (b - a).norm();
        if (here < along - 0.01) continue;
        along = std::max(along, here);
        found = true;
        break;
      }
      ASSERT_TRUE(found) << "layer " << k << " ruling " << r << " goes back";
    }
  }
}

TEST_P(EveryShape, ExactWaysDoNotCross) {
  const CurveFlow exact = flow(GetParam().curve);
  for (const int k : {7, 20, 36, -7, -20, -36}) {
    const auto& feet = exact.layer(k).feet;
    int count = 0;
    for (std::size_t i = 0; i < feet.size(); ++i)
      for (std::size_t j = i + 1; j < feet.size(); ++j)
        if (feet[i] && feet[j])
          count += cross_properly(exact.rulings[i].at, *feet[i], exact.rulings[j].at, *feet[j]);
    EXPECT_EQ(count, 0) << "layer " << k;
  }
}

TEST_P(EveryShape, ExactFootIsTheRulingsOwnWhereThatSurvives) {
  const Curve& curve = GetParam().curve;
  const CurveFlow exact = flow(curve);
  for (const int k : layers())
    for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
      const RulingFoot& ruling = exact.rulings[i];
      const PlanePoint span = curve.edge_end(ruling.edge) - curve.edge_start(ruling.edge);
      // On a vertex the normal is not one.
      if (ruling.along_mm < 1e-6 || ruling.along_mm > span.norm() - 1e-6) continue;
      const PlanePoint own = ruling.at + k * quarter_turn(span).normalized();
      const double distance = test::distance_to_curve(own, curve);
      const auto& foot = exact.layer(k).feet[i];
      if (distance > std::abs(k) - 1e-9) {
        ASSERT_TRUE(foot) << "layer " << k << " ruling " << i;
        EXPECT_LT((*foot - own).norm(), 1e-9) << "layer " << k << " ruling " << i;
      } else if (distance < std::abs(k) - 1e-6 && foot) {
        EXPECT_GT((*foot - own).norm(), 1e-9) << "layer " << k << " ruling " << i;
      }
    }
}

// On gentle shapes nothing has vanished and no window is needed: the nearest point of the whole front is it.
TEST_P(GentleShape, ExactFeetAreTheNearestOfTheWholeFront) {
  const CurveFlow exact = flow(GetParam().curve);
  for (const int k : layers())
    for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
      const auto& foot = exact.layer(k).feet[i];
      ASSERT_TRUE(foot) << "layer " << k << " ruling " << i;
      const PlanePoint& p = exact.rulings[i].at;
      EXPECT_NEAR((*foot - p).norm(), test::distance_to_lines(p, exact.layer(k).front), 0.003)
          << "layer " << k << " ruling " << i;
    }
}

TEST_P(GentleShape, NaiveBreaksTheDistanceLaw) {
  const Curve& curve = GetParam().curve;
  const int wrong = misplaced_in_all(curve, FlowMethod::naive);
  if (GetParam().name.starts_with("straight")) {
    EXPECT_EQ(wrong, 0);
  } else {
    EXPECT_GT(wrong, 0);
  }
}

// Figure 9b: the swallowtail of a tight corner, and the same structure shown twice.
TEST(Figure9, NaiveFrontsOfACornerCrossThemselves) {
  for (const int angle : {50, 85, 120, 145}) {
    const Curve v = test::v_curve(angle, 200);
    EXPECT_GT(crossings_in_all(v, FlowMethod::naive), 0) << angle;
    EXPECT_GT(misplaced_in_all(v, FlowMethod::naive), 0) << angle;
    EXPECT_EQ(crossings_in_all(v, FlowMethod::exact), 0) << angle;
    EXPECT_EQ(crossings_in_all(v, FlowMethod::route_map), 0) << angle;
    EXPECT_EQ(misplaced_in_all(v, FlowMethod::route_map), 0) << angle;
  }
}

// Every tight bend of a drawn line does it, too; nowhere an exact front.
TEST(Figure9, NaiveFrontsOfDrawnLinesCrossThemselves) {
  int crossing = 0;
  for (const Shape& shape : test::all_shapes()) {
    // Smoothed ones need not: their bends may be wider than the band.
    if (shape.name != "zigzag" && !shape.name.starts_with("raw_stroke")) continue;
    ++crossing;
    EXPECT_GT(crossings_in_all(shape.curve, FlowMethod::naive), 0) << shape.name;
  }
  EXPECT_EQ(crossing, 3);
}

// Measured failures of the paper's route map on curves that come back within the band, or were not smoothed.
TEST(Figure10, RouteMapRunsThroughWhatIsNotItsNeighbour) {
  for (const Shape& shape : test::hard_shapes()) {
    if (shape.name != "hairpin_narrower_than_the_band" && shape.name != "pocket" && shape.name != "spiral" &&
        shape.name != "raw_stroke")
      continue;
    EXPECT_GT(misplaced_in_all(shape.curve, FlowMethod::route_map), 0) << shape.name;
  }
}

TEST_P(GentleShape, RouteMapAgreesWithExact) {
  const Curve& curve = GetParam().curve;
  const CurveFlow exact = flow(curve);
  const CurveFlow paper = flow(curve, FlowMethod::route_map);
  for (int k = -last_layer; k <= last_layer; ++k)
    for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
      // A ruling on a convex vertex has a whole arc at its disposal.
      const RulingFoot& ruling = exact.rulings[i];
      const double length = (curve.edge_end(ruling.edge) - curve.edge_start(ruling.edge)).norm();
      if (ruling.along_mm < 1e-6 || ruling.along_mm > length - 1e-6) continue;
      ASSERT_TRUE(exact.layer(k).feet[i] && paper.layer(k).feet[i]);
      ASSERT_LT((*exact.layer(k).feet[i] - *paper.layer(k).feet[i]).norm(), 0.5)
          << "layer " << k << " ruling " << i;
    }
}

TEST(Flow, HairpinNarrowerThanTheBandHasNoInnerFront) {
  for (const Shape& shape : test::hard_shapes()) {
    if (shape.name != "hairpin_narrower_than_the_band") continue;
    const CurveFlow exact = flow(shape.curve);
    // The bend turns towards +y: the inner side is that of the quarter turn. Half width 25.
    EXPECT_FALSE(exact.layer(25).front.empty());
    for (int k = 26; k <= last_layer; ++k) {
      EXPECT_TRUE(exact.layer(k).front.empty()) << k;
      for (const auto& foot : exact.layer(k).feet) EXPECT_FALSE(foot) << k;
    }
    for (const auto& foot : exact.layer(-last_layer).feet) EXPECT_TRUE(foot);
  }
}

// Between two turns of a spiral the front vanishes at half the pitch; nothing reaches through a wall.
TEST(Flow, SpiralNeverReachesForAnotherTurn) {
  for (const Shape& shape : test::hard_shapes()) {
    if (!shape.name.starts_with("spiral")) continue;
    const CurveFlow exact = flow(shape.curve);
    for (int k = -last_layer; k <= last_layer; ++k)
      for (std::size_t i = 0; i < exact.rulings.size(); ++i) {
        const auto& foot = exact.layer(k).feet[i];
        if (!foot) continue;
        for (int e = 0; e < shape.curve.edges(); ++e)
          ASSERT_FALSE(
              cross_properly(exact.rulings[i].at, *foot, shape.curve.edge_start(e), shape.curve.edge_end(e)))
              << "layer " << k << " ruling " << i;
      }
  }
}

}  // namespace
}  // namespace sonoband
