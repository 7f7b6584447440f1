#include "tests/core/manifold/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sonoband::test {

namespace {

Curve smoothed(const std::vector<PlanePoint>& points) {
  return make_curve(points, {.pixel_mm = 1, .smooth_px = 4}).curve;
}

Curve hairpin(double half_width) {
  std::vector<PlanePoint> points;
  for (int i = 0; i <= 20; ++i) points.emplace_back(i * 10.0, 0);
  for (int i = 1; i < 20; ++i) {
    const double a = -M_PI / 2 + M_PI * i / 20;
    points.emplace_back(200 + half_width * std::cos(a), half_width + half_width * std::sin(a));
  }
  for (int i = 0; i <= 20; ++i) points.emplace_back(200 - i * 10.0, 2 * half_width);
  return open_curve(points);
}

Curve spiral(double inner, double pitch, double turns) {
  std::vector<PlanePoint> points;
  for (double a = 0; a <= 2 * M_PI * turns; a += 0.08) {
    const double r = inner + pitch * a / (2 * M_PI);
    points.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return open_curve(points);
}

}  // namespace

Curve open_curve(std::vector<PlanePoint> points) {
  return {std::move(points), false};
}

Curve closed_curve(std::vector<PlanePoint> points) {
  return {std::move(points), true};
}

Curve v_curve(double between_deg, double arm) {
  const double half = between_deg / 2 * M_PI / 180;
  return open_curve(
      {{arm * std::cos(half), arm * std::sin(half)}, {0, 0}, {arm * std::cos(half), -arm * std::sin(half)}});
}

Curve circle(double radius, int corners) {
  std::vector<PlanePoint> points;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * M_PI * i / corners;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a));
  }
  return closed_curve(points);
}

std::vector<PlanePoint> stroke(unsigned seed, int points, double jitter) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> phase(0, 2 * M_PI);
  double amplitude[6], shift[6];
  for (int k = 0; k < 6; ++k) {
    amplitude[k] = gauss(random) / (k + 1);
    shift[k] = phase(random);
  }
  std::vector<PlanePoint> line;
  PlanePoint at(0, 0);
  for (int i = 0; i < points; ++i) {
    line.push_back(at + jitter * PlanePoint(gauss(random), gauss(random)));
    double heading = 0;
    for (int k = 0; k < 6; ++k)
      heading += amplitude[k] * std::sin(2 * M_PI * (k + 1) * 0.7 * i / points + shift[k]);
    at += 2 * PlanePoint(std::cos(heading), std::sin(heading));
  }
  return line;
}

std::vector<Shape> gentle_shapes() {
  std::vector<Shape> shapes{
      {"straight", open_curve({{0, 0}, {200, 0}})},
      {"straight_with_vertices", open_curve({{0, 0}, {50, 25}, {100, 50}, {101, 50.5}, {200, 100}})},
      {"zigzag", open_curve({{0, 0}, {60, 40}, {120, 0}, {180, 40}, {240, 0}, {300, 40}})},
      {"hairpin_wider_than_the_band", hairpin(45)},
      {"circle", circle(60, 180)},
  };
  for (const int angle : {30, 60, 90, 120, 150, 175})
    shapes.push_back({"v_" + std::to_string(angle), v_curve(angle, 200)});
  for (unsigned seed = 1; seed <= 3; ++seed) {
    shapes.push_back({"smooth_" + std::to_string(seed), open_curve(stroke(seed, 300, 0))});
    shapes.push_back({"smoothed_stroke_" + std::to_string(seed), smoothed(stroke(seed, 300, 0.3))});
  }
  return shapes;
}

std::vector<Shape> hard_shapes() {
  std::vector<PlanePoint> loop;
  for (int i = 0; i <= 60; ++i) {
    const double a = M_PI * 1.75 - 2.5 * M_PI * i / 60;
    loop.emplace_back(60 * std::cos(a) + i * 0.5, 60 * std::sin(a));
  }
  std::vector<PlanePoint> star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? 80 : 30;
    star.emplace_back(r * std::cos(i * M_PI / 5), r * std::sin(i * M_PI / 5));
  }
  return {
      {"hairpin_narrower_than_the_band", hairpin(25)},
      {"hairpin_smoothed", smoothed(hairpin(12).vertices)},
      {"pocket", open_curve({{0, 0}, {200, 0}, {200, 100}, {110, 100}, {100, 25}, {90, 100}, {0, 100}})},
      {"pocket_with_a_neck", open_curve({{0, 0},
                                         {90, 0},
                                         {90, -30},
                                         {40, -30},
                                         {40, -120},
                                         {160, -120},
                                         {160, -30},
                                         {110, -30},
                                         {110, 0},
                                         {200, 0}})},
      {"spiral", spiral(20, 26, 2.5)},
      {"spiral_inwards", reversed(spiral(20, 26, 2.5))},
      {"loop", open_curve(loop)},
      {"figure_of_eight", smoothed({{0, 0}, {150, 100}, {150, 0}, {0, 100}, {-50, 50}})},
      {"raw_stroke", open_curve(stroke(1, 300, 0.3))},
      {"raw_stroke_2", open_curve(stroke(2, 300, 0.3))},
      {"star", closed_curve(star)},
      {"small_ring", circle(20, 40)},
      {"back_along_itself", open_curve({{0, 0}, {100, 0}, {40, 0}, {40, 60}})},
      {"needle", open_curve({{0, 0}, {100, 0}, {100, 1e-7}, {0, 1e-3}})},
      {"short_end", open_curve({{0, 0}, {0, 10}, {150, 10}})},
  };
}

std::vector<Shape> all_shapes() {
  std::vector<Shape> shapes = gentle_shapes();
  for (Shape& shape : hard_shapes()) shapes.push_back(std::move(shape));
  return shapes;
}

std::vector<PlanePoint> nasty_stroke(std::mt19937& random) {
  std::uniform_int_distribution<int> count(0, 25), habit(0, 8), lattice(-4, 4), rare(0, 400);
  std::uniform_real_distribution<double> wide(-60, 60), tiny(-1e-7, 1e-7);
  std::vector<PlanePoint> points;
  const int n = count(random);
  while (static_cast<int>(points.size()) < n) {
    const PlanePoint last = points.empty() ? PlanePoint(0, 0) : points.back();
    const PlanePoint before = points.size() < 2 ? PlanePoint(1, 0) : points[points.size() - 2];
    switch (habit(random)) {
      case 0:
        points.push_back(last);
        break;
      case 1:
        points.push_back(last + 0.5 * (last - before));
        break;
      case 2:
        points.push_back(before);
        break;
      case 3:
        points.push_back(last + PlanePoint(tiny(random), tiny(random)));
        break;
      case 4:
        points.push_back(0.5 * (last + before));
        break;
      case 5:
        points.emplace_back(wide(random), wide(random));
        break;
      default:
        points.emplace_back(10 * lattice(random), 10 * lattice(random));
    }
    if (rare(random) == 0) points.back().x() = std::numeric_limits<double>::quiet_NaN();
    if (rare(random) == 0) points.back().y() = 1e200;
  }
  return points;
}

Curve reversed(const Curve& curve) {
  Curve back = curve;
  // A closed curve keeps its first vertex, so that rulings stay at the same places.
  std::reverse(back.vertices.begin() + (curve.closed ? 1 : 0), back.vertices.end());
  return back;
}

double distance_to_curve(const PlanePoint& p, const Curve& curve) {
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < curve.edges(); ++e)
    least =
        std::min(least, (p - nearest_on_segment(p, curve.edge_start(e), curve.edge_end(e))).squaredNorm());
  return std::sqrt(least);
}

double distance_to_lines(const PlanePoint& p, const std::vector<PlaneLine>& lines) {
  double least = std::numeric_limits<double>::infinity();
  for (const PlaneLine& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i)
      least = std::min(least, (p - nearest_on_segment(p, line[i - 1], line[i])).squaredNorm());
  return std::sqrt(least);
}

}  // namespace sonoband::test
