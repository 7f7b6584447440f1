#include "core/manifold/curve.h"

#include <cassert>
#include <cmath>

#include "core/manifold/chord_tree.h"
#include "core/manifold/smooth.h"

namespace sonoband {

namespace {

// Closer than this share of the whole length, two points are one and a line is straight.
constexpr double same_place = 1e-9;

double length_of(const std::vector<PlanePoint>& points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

void drop_repeated(std::vector<PlanePoint>& points, bool closed) {
  const double limit = same_place * length_of(points);
  std::size_t kept = 0;
  for (const PlanePoint& p : points)
    if (kept == 0 || (p - points[kept - 1]).norm() > limit) points[kept++] = p;
  points.resize(kept);
  while (closed && points.size() > 1 && (points.back() - points.front()).norm() <= limit) points.pop_back();
}

bool is_straight(const std::vector<PlanePoint>& points) {
  const PlanePoint chord = points.back() - points.front();
  const double length = chord.norm();
  const double limit = same_place * length;
  if (length == 0) return false;
  double reached = 0;
  for (const PlanePoint& p : points) {
    const PlanePoint from_start = p - points.front();
    const double along = from_start.dot(chord) / length;
    if (std::abs(cross(chord, from_start)) / length > limit || along < reached - limit) return false;
    reached = along;
  }
  return true;
}

CurveFault fault_of(const std::vector<PlanePoint>& vertices, bool closed) {
  if (vertices.size() < 2) return CurveFault::one_point;
  if (closed && vertices.size() < 3) return CurveFault::closed_too_few;
  return CurveFault::none;
}

}  // namespace

double length_mm(const Curve& curve) {
  double sum = length_of(curve.vertices);
  if (curve.closed) sum += (curve.vertices.front() - curve.vertices.back()).norm();
  return sum;
}

std::string_view describe(CurveFault fault) {
  switch (fault) {
    case CurveFault::none:
      return "is good";
    case CurveFault::bad_settings:
      return "needs a pixel above 0 mm and a smoothing from 0 to 1000 px";
    case CurveFault::no_points:
      return "has no points; draw at least two";
    case CurveFault::not_finite:
      return "has a coordinate that is not a finite number; give every point in mm";
    case CurveFault::one_point:
      return "has all its points in one place; draw at least two different ones";
    case CurveFault::closed_too_few:
      return "is closed but has fewer than three different points; add one or leave it open";
    case CurveFault::too_long:
      return "is longer than 65536 pixels or points; draw a shorter one or take larger pixels";
  }
  return "is unknown";
}

CurveResult make_curve(std::span<const PlanePoint> stroke, const CurveSettings& settings) {
  CurveResult result;
  const auto refuse = [&](CurveFault fault, std::size_t point = 0) {
    result.curve = {};
    result.fault = fault;
    result.point = point;
    return std::move(result);
  };
  // Written so that NaN is refused too.
  if (!(settings.pixel_mm > 0 && std::isfinite(settings.pixel_mm))) return refuse(CurveFault::bad_settings);
  if (!(settings.smooth_px >= 0 && settings.smooth_px <= max_smooth_px))
    return refuse(CurveFault::bad_settings);
  if (stroke.empty()) return refuse(CurveFault::no_points);
  if (stroke.size() > max_curve_px) return refuse(CurveFault::too_long);
  for (std::size_t i = 0; i < stroke.size(); ++i)
    if (!stroke[i].allFinite()) return refuse(CurveFault::not_finite, i);

  Curve curve{{stroke.begin(), stroke.end()}, settings.closed};
  if (!(length_of(curve.vertices) <= max_curve_px * settings.pixel_mm)) return refuse(CurveFault::too_long);
  drop_repeated(curve.vertices, curve.closed);
  if (const CurveFault fault = fault_of(curve.vertices, curve.closed); fault != CurveFault::none)
    return refuse(fault);

  if (settings.smooth_px > 0) {
    curve.vertices = smooth_along(resample(curve, settings.pixel_mm), curve.closed, settings.smooth_px);
    drop_repeated(curve.vertices, curve.closed);
    if (const CurveFault fault = fault_of(curve.vertices, curve.closed); fault != CurveFault::none)
      return refuse(fault);
  }
  if (!curve.closed && is_straight(curve.vertices))
    curve.vertices = {curve.vertices.front(), curve.vertices.back()};
  result.curve = std::move(curve);
  result.crosses_itself = crosses_itself(result.curve);
  return result;
}

bool crosses_itself(const Curve& curve) {
  std::vector<PlanePoint> line = curve.vertices;
  if (curve.closed) line.push_back(line.front());
  const ChordTree tree(line);
  const int edges = curve.edges();
  bool found = false;
  for (int i = 0; i < edges && !found; ++i) {
    const PlanePoint& p = line[i];
    const PlanePoint& q = line[i + 1];
    const PlanePoint pq = q - p;
    const PlanePoint middle = 0.5 * (p + q);
    const double half = 0.5 * pq.norm();
    const auto far_away = [&](const ChordTree::Run& run) {
      return distance_to_segment(middle, run.a, run.b) > half + run.stray;
    };
    tree.visit(far_away, [&](int j) {
      // Each pair once; neighbours share a vertex and do not count.
      if (j < i + 2 || (curve.closed && i == 0 && j == edges - 1)) return;
      const PlanePoint& a = line[j];
      const PlanePoint& b = line[j + 1];
      const bool parts_ab = cross(pq, a - p) * cross(pq, b - p) <= 0;
      const bool parts_pq = cross(b - a, p - a) * cross(b - a, q - a) <= 0;
      const bool parallel = cross(pq, b - a) == 0;
      if (parts_ab && parts_pq && !parallel) found = true;
    });
  }
  return found;
}

std::vector<RulingFoot> ruling_feet(const Curve& curve, double spacing_mm) {
  assert(curve.edges() > 0 && spacing_mm > 0);
  const double length = length_mm(curve);
  const int intervals = static_cast<int>(std::floor(length / spacing_mm + 0.5));
  double spacing = intervals > 0 ? length / intervals : 0.0;
  // So that rows of a straight curve fall on those of a plane to the last bit.
  if (std::abs(spacing - spacing_mm) <= same_place * spacing_mm) spacing = spacing_mm;

  std::vector<RulingFoot> feet;
  feet.reserve(intervals + 1);
  int edge = 0;
  double edge_begins = 0;
  PlanePoint direction = curve.edge_end(0) - curve.edge_start(0);
  double edge_length = direction.norm();
  direction /= edge_length;
  for (int row = 0; row <= intervals; ++row) {
    const double at = row * spacing;
    while (at > edge_begins + edge_length && edge + 1 < curve.edges()) {
      edge_begins += edge_length;
      ++edge;
      direction = curve.edge_end(edge) - curve.edge_start(edge);
      edge_length = direction.norm();
      direction /= edge_length;
    }
    const double along = std::min(at - edge_begins, edge_length);
    feet.push_back({curve.edge_start(edge) + along * direction, edge, along});
  }
  return feet;
}

}  // namespace sonoband
