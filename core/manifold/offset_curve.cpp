#include "core/manifold/offset_curve.h"

#include <cmath>

namespace sonoband::flow {

namespace {

// A ruling nearer than this to a vertex, in steps, stands on it.
constexpr double on_vertex = 1e-9;
// A turn below this, in radians, is none: the arc would be a millionth of a step long at 1000 layers.
constexpr double no_turn = 1e-9;

Side::Corner corner_between(const Side::Edge& before, const Side::Edge& after, double sign) {
  Side::Corner corner;
  corner.at = before.start + before.length * before.along;
  const double turn = turn_away(before.along, after.along, sign);
  const double c = std::cos(turn / 2), s = std::sin(turn / 2);
  corner.along = c * before.along - s * before.out;
  corner.out = c * before.out + s * before.along;
  if (turn > no_turn) corner.half_angle = turn / 2;
  corner.reach = std::tan(turn / 2);
  return corner;
}

}  // namespace

double turn_away(const PlanePoint& along_before, const PlanePoint& along_after, double sign) {
  const double sine = -sign * cross(along_before, along_after);
  const double cosine = along_before.dot(along_after);
  if (cosine < 0 && std::abs(sine) < no_turn) return M_PI;
  return std::atan2(sine, cosine);
}

OffsetCurve::OffsetCurve(const Curve& curve, double step_mm) : step_mm_(step_mm) {
  PlanePoint low = curve.vertices.front();
  PlanePoint high = low;
  for (const PlanePoint& v : curve.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  centroid_mm_ = 0.5 * (low + high);
  for (Side& side : sides_) {
    side.sign = &side == &sides_[0] ? 1 : -1;
    side.closed = curve.closed;
    for (const PlanePoint& v : curve.vertices) side.vertices.push_back((v - centroid_mm_) / step_mm);
    if (curve.closed) side.vertices.push_back(side.vertices.front());
    const int edges = curve.edges();
    for (int e = 0; e < edges; ++e) {
      const PlanePoint span = side.vertices[e + 1] - side.vertices[e];
      const double length = span.norm();
      const PlanePoint along = span / length;
      side.edges.push_back({side.vertices[e], along, side.sign * quarter_turn(along), length});
    }
    for (int e = 0; e + 1 < edges; ++e)
      side.corners.push_back(corner_between(side.edges[e], side.edges[e + 1], side.sign));
    if (curve.closed)
      side.corners.push_back(corner_between(side.edges.back(), side.edges.front(), side.sign));
  }
}

std::vector<Standing> OffsetCurve::stand(const Side& side, const std::vector<RulingFoot>& rulings) const {
  std::vector<Standing> standing;
  standing.reserve(rulings.size());
  for (const RulingFoot& ruling : rulings) {
    const double along = ruling.along_mm / step_mm_;
    Standing s{(ruling.at - centroid_mm_) / step_mm_, edge_element(ruling.edge), along};
    const bool at_end = along >= side.edges[ruling.edge].length - on_vertex;
    int corner = -1;
    if (at_end && ruling.edge < static_cast<int>(side.corners.size())) corner = ruling.edge;
    if (along <= on_vertex && ruling.edge > 0) corner = ruling.edge - 1;
    if (corner >= 0 && side.corners[corner].half_angle > 0) s = {s.at, corner_element(corner), 0};
    standing.push_back(s);
  }
  return standing;
}

PlanePoint point_at(const Side& side, int element, double at, double height) {
  if (element % 2 == 0) {
    const Side::Edge& edge = side.edges[element / 2];
    return edge.start + at * edge.along + height * edge.out;
  }
  const Side::Corner& corner = side.corners[element / 2];
  return corner.at + height * (std::sin(at) * corner.along + std::cos(at) * corner.out);
}

double nearest_at(const Side& side, int element, const PlanePoint& p, double from, double to) {
  if (element % 2 == 0) {
    const Side::Edge& edge = side.edges[element / 2];
    return std::clamp((p - edge.start).dot(edge.along), from, to);
  }
  // On a circle the nearest point is the one in the direction of p; outside the arc the end nearer in angle.
  const Side::Corner& corner = side.corners[element / 2];
  const PlanePoint offset = p - corner.at;
  if (offset.norm() <= on_vertex) return std::clamp(0.0, from, to);
  const double angle = std::atan2(offset.dot(corner.along), offset.dot(corner.out));
  if (angle >= from && angle <= to) return angle;
  const double before = std::remainder(from - angle, 2 * M_PI);
  const double after = std::remainder(to - angle, 2 * M_PI);
  return std::abs(before) <= std::abs(after) ? from : to;
}

}  // namespace sonoband::flow
