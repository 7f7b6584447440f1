// Whatever comes from a finger or a file: no crash, no hang, and the first law wherever there is a front.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/manifold/flow.h"
#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

TEST(FlowOfAnything, NeverFailsAndKeepsItsDistance) {
  std::mt19937 random(20);
  Serial serial;
  int made = 0;
  for (int round = 0; round < 250; ++round) {
    const auto points = test::nasty_stroke(random);
    const CurveSettings settings{
        .pixel_mm = 1, .smooth_px = round % 3 == 0 ? 4.0 : 0.0, .closed = round % 5 == 0};
    const CurveResult result = make_curve(points, settings);
    if (result.fault != CurveFault::none) continue;
    ++made;
    for (const FlowMethod method : {FlowMethod::exact, FlowMethod::route_map, FlowMethod::naive}) {
      const CurveFlow flow = flow_curve(
          result.curve,
          {.method = method, .step_mm = 1, .layers = 12, .ruling_mm = 1, .fronts = Fronts::outermost},
          serial);
      for (const FlowLayer& layer : flow.layers) {
        ASSERT_EQ(layer.feet.size(), flow.rulings.size());
        for (const auto& foot : layer.feet) {
          if (!foot) continue;
          ASSERT_TRUE(foot->allFinite());
          if (method != FlowMethod::exact || layer.k % 4 != 0) continue;
          ASSERT_NEAR(test::distance_to_curve(*foot, result.curve), std::abs(layer.k), 0.01)
              << "round " << round << " layer " << layer.k;
        }
        for (const PlaneLine& line : layer.front)
          for (const PlanePoint& p : line) ASSERT_TRUE(p.allFinite());
      }
    }
  }
  EXPECT_GT(made, 150);
}

// Strokes of many hands, smoothed as the product does: nothing wrong in any layer, exact or paper's.
TEST(FlowOfAnything, SmoothedStrokesHoldTheLaws) {
  Serial serial;
  for (unsigned seed = 10; seed < 20; ++seed) {
    const Curve curve = make_curve(test::stroke(seed, 120, 0.3), {.pixel_mm = 1}).curve;
    const CurveFlow exact = flow_curve(curve, {.step_mm = 1, .layers = 36, .ruling_mm = 1}, serial);
    for (const int k : {-36, -18, -1, 1, 18, 36})
      for (const auto& foot : exact.layer(k).feet) {
        if (!foot) continue;
        ASSERT_NEAR(test::distance_to_curve(*foot, curve), std::abs(k), 0.01) << seed << " " << k;
      }
  }
}

TEST(FlowOfAnything, ShortestCurvesHaveFronts) {
  Serial serial;
  for (const double length : {1e-6, 0.3, 0.7, 3.0}) {
    const CurveResult made = make_curve(std::vector<PlanePoint>{{5, 5}, {5, 5 + length}}, {.pixel_mm = 1});
    ASSERT_EQ(made.fault, CurveFault::none);
    const CurveFlow flow = flow_curve(made.curve, {.step_mm = 1, .layers = 5, .ruling_mm = 1}, serial);
    EXPECT_EQ(flow.rulings.size(), static_cast<std::size_t>(std::floor(length + 0.5)) + 1);
  }
}

TEST(FlowOfAnything, NoLayersIsTheSurfaceAlone) {
  Serial serial;
  const Curve line = test::open_curve({{0, 0}, {10, 0}});
  EXPECT_EQ(flow_curve(line, {.step_mm = 1, .layers = 0, .ruling_mm = 1}, serial).layers.size(), 1u);
}

}  // namespace
}  // namespace sonoband
