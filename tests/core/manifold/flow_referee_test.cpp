// The exact front against independent referees: a brute-force distance map, Clipper's round offset, and
// itself (Huygens: the front of a front is the next front).
#include <gtest/gtest.h>

#include <clipper.hpp>
#include <cmath>
#include <set>

#include "core/manifold/flow.h"
#include "tests/core/manifold/shapes.h"

namespace sonoband {
namespace {

using test::Shape;

CurveFlow flow(const Curve& curve, int layers) {
  Serial serial;
  return flow_curve(curve, {.step_mm = 1, .layers = layers, .ruling_mm = 1, .fronts = Fronts::all}, serial);
}

// Both sides' fronts and the round ends that an offset outline has and a front does not.
std::vector<PlaneLine> outline(const CurveFlow& result, const Curve& curve, int k) {
  std::vector<PlaneLine> lines = result.layer(k).front;
  for (const PlaneLine& line : result.layer(-k).front) lines.push_back(line);
  if (curve.closed) return lines;
  for (const bool last : {false, true}) {
    const PlanePoint& end = last ? curve.vertices.back() : curve.vertices.front();
    const PlanePoint inwards =
        last ? curve.vertices[curve.vertices.size() - 2] - end : curve.vertices[1] - end;
    const double first = std::atan2(inwards.y(), inwards.x()) + M_PI / 2;
    const auto at = [&](double a) -> PlanePoint { return end + k * PlanePoint(std::cos(a), std::sin(a)); };
    const auto free = [&](double a) { return test::distance_to_curve(at(a), curve) > k - 1e-6; };
    // Ends of a cap, where the curve shades it, by bisection.
    const auto boundary = [&](double in, double out) {
      for (int i = 0; i < 20; ++i) (free(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
      return at(in);
    };
    PlaneLine cap;
    for (int i = 0; i <= 180; ++i) {
      const double a = first + M_PI * i / 180, before = a - M_PI / 180;
      if (free(a)) {
        if (i > 0 && cap.empty()) cap.push_back(boundary(a, before));
        cap.push_back(at(a));
      } else if (!cap.empty()) {
        cap.push_back(boundary(before, a));
        lines.push_back(std::move(cap));
        cap.clear();
      }
    }
    lines.push_back(std::move(cap));
  }
  return lines;
}

class Referee : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Flow, Referee, testing::ValuesIn(test::all_shapes()),
                         [](const auto& shape) { return shape.param.name; });

// The curve in pieces that do not turn straight back. Where a path does, Clipper tells left from right by a
// cross product of zero, whose sign is that of a rounding error (on arm64 the round end is missing there);
// the union of what the pieces reach is the same set.
std::vector<Curve> without_returns(const Curve& curve) {
  std::vector<PlanePoint> points = curve.vertices;
  const std::size_t n = points.size();
  const auto returns = [&](std::size_t i) {
    if (!curve.closed && (i == 0 || i + 1 == n)) return false;
    const PlanePoint in = points[i] - points[(i + n - 1) % n], out = points[(i + 1) % n] - points[i];
    return in.dot(out) < (1e-9 - 1) * in.norm() * out.norm();
  };
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < n; ++i)
    if (returns(i)) cuts.push_back(i);
  if (cuts.empty()) return {curve};
  std::vector<Curve> pieces;
  const auto add = [&](std::size_t from, std::size_t to) {
    Curve& piece = pieces.emplace_back();
    for (std::size_t i = from; i <= to; ++i) piece.vertices.push_back(points[i % n]);
  };
  if (!curve.closed) {
    cuts.insert(cuts.begin(), 0);
    cuts.push_back(n - 1);
  } else {
    cuts.push_back(cuts.front() + n);
  }
  for (std::size_t c = 1; c < cuts.size(); ++c) add(cuts[c - 1], cuts[c]);
  return pieces;
}

// Each point of Clipper's round offset of the whole path lies on our outline and the other way round.
void agree_with_clipper(const Curve& curve, const std::vector<int>& layers) {
  constexpr double unit = 1e5;  // integers per mm
  const std::vector<Curve> pieces = without_returns(curve);
  const CurveFlow result = flow(curve, layers.back());
  for (const int k : layers) {
    ClipperLib::ClipperOffset offset(2, 0.002 * unit);
    for (const Curve& piece : pieces) {
      ClipperLib::Path path;
      for (const PlanePoint& v : piece.vertices)
        path.emplace_back(std::llround(v.x() * unit), std::llround(v.y() * unit));
      offset.AddPath(path, ClipperLib::jtRound,
                     piece.closed ? ClipperLib::etClosedLine : ClipperLib::etOpenRound);
    }
    ClipperLib::Paths paths;
    offset.Execute(paths, k * unit);
    std::vector<PlaneLine> theirs;
    for (const ClipperLib::Path& p : paths) {
      PlaneLine line;
      for (const ClipperLib::IntPoint& q : p) line.emplace_back(q.X / unit, q.Y / unit);
      line.push_back(line.front());
      theirs.push_back(std::move(line));
    }
    const std::vector<PlaneLine> ours = outline(result, curve, k);
    for (const PlaneLine& line : theirs)
      for (std::size_t i = 0; i < line.size(); i += 3)
        ASSERT_LT(test::distance_to_lines(line[i], ours), 0.02) << k << " at " << line[i].transpose();
    for (const int sign : {-1, 1})
      for (const PlaneLine& line : result.layer(sign * k).front)
        for (std::size_t i = 0; i < line.size(); i += 3)
          ASSERT_LT(test::distance_to_lines(line[i], theirs), 0.02) << k << " at " << line[i].transpose();
  }
}

TEST_P(Referee, OutlineIsClippersRoundOffset) {
  agree_with_clipper(GetParam().curve, {3, 13, 26, 36});
}

TEST(Flow, OutlineOfAnythingIsClippersRoundOffset) {
  std::mt19937 random(4);
  int made = 0;
  for (int round = 0; round < 60; ++round) {
    const CurveResult curve =
        make_curve(test::nasty_stroke(random), {.pixel_mm = 1, .smooth_px = 0, .closed = round % 4 == 0});
    if (curve.fault != CurveFault::none) continue;
    ++made;
    SCOPED_TRACE(round);
    agree_with_clipper(curve.curve, {2, 9});
  }
  EXPECT_GT(made, 30);
}

// Where the distance map crosses k on a grid of a quarter step, there is our outline within one diagonal.
TEST_P(Referee, OutlineIsTheDistanceMapsContour) {
  const Curve& curve = GetParam().curve;
  PlanePoint low = curve.vertices.front(), high = low;
  for (const PlanePoint& v : curve.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  constexpr int k = 17;
  const CurveFlow result = flow(curve, k);
  const std::vector<PlaneLine> ours = outline(result, curve, k);
  constexpr double cell = 0.25;
  // Lines of the grid, 7 mm apart, each walked in quarter steps.
  int contours = 0;
  for (double y = low.y() - k; y <= high.y() + k; y += 7) {
    double before = test::distance_to_curve({low.x() - k - 1, y}, curve);
    for (double x = low.x() - k - 1; x <= high.x() + k + 1;) {
      // The distance changes by no more than the way: skip what cannot reach k.
      x += std::max(cell, std::abs(before - k) - cell);
      const double here = test::distance_to_curve({x, y}, curve);
      if ((here - k) * (before - k) < 0) {
        ++contours;
        ASSERT_LT(test::distance_to_lines({x, y}, ours), cell * std::sqrt(2)) << x << " " << y;
      }
      before = here;
    }
  }
  EXPECT_GT(contours, 0);
}

// Huygens: the exact front of layer 13 of each unbroken line of layer 7, taken as a curve, is layer 20.
TEST_P(Referee, FrontOfAFrontIsTheNextFront) {
  const CurveFlow result = flow(GetParam().curve, 20);
  for (const int sign : {-1, 1}) {
    const auto& first = result.layer(7 * sign).front;
    const auto& last = result.layer(20 * sign).front;
    if (first.size() != 1) continue;  // lines of a broken front shade each other
    Curve middle{first[0], false};
    if (middle.vertices.front() == middle.vertices.back()) {
      middle.vertices.pop_back();
      middle.closed = true;
    }
    const CurveFlow onwards = flow(middle, 13);
    for (const PlaneLine& line : onwards.layer(13 * sign).front)
      for (std::size_t i = 0; i < line.size(); i += 3) {
        // Beside a broken-off end the new front may go on where the curve's own end shades the old one.
        if (test::distance_to_curve(line[i], GetParam().curve) < 20 - 0.05) continue;
        ASSERT_LT(test::distance_to_lines(line[i], last), 0.1) << line[i].transpose();
      }
    for (const PlaneLine& line : last)
      for (std::size_t i = 0; i < line.size(); i += 3)
        ASSERT_LT(test::distance_to_lines(line[i], onwards.layer(13 * sign).front), 0.1)
            << line[i].transpose();
  }
}

}  // namespace
}  // namespace sonoband
