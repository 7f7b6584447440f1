#include "core/manifold/trim.h"

#include <cmath>

namespace sonoband::flow {

namespace {
// Overlaps thinner than these, in steps, are rounding: a curve that runs back along itself does not shade
// itself.
constexpr double least_height = 1e-9;
constexpr double least_rise = 1e-7;
}  // namespace

double touch_radius(const PlanePoint& out, const PlanePoint& q) {
  const double height = out.dot(q);
  return height > least_height ? q.squaredNorm() / (2 * height) : never;
}

double touch_radius(const PlanePoint& out, const PlanePoint& a, const PlanePoint& b) {
  double radius = std::min(touch_radius(out, a), touch_radius(out, b));
  const PlanePoint span = b - a;
  const double length = span.norm();
  if (length == 0 || std::max(out.dot(a), out.dot(b)) <= least_rise) return radius;
  const PlanePoint t = span / length;
  // The line's unit normal that points away from the origin; a disc centred at r out touches the line when
  // r = distance - r normal.out, on the origin's side.
  PlanePoint normal = quarter_turn(t);
  double distance = normal.dot(a);
  if (distance < 0) {
    normal = -normal;
    distance = -distance;
  }
  const double fall = 1 + normal.dot(out);
  if (fall <= 0) return radius;
  const double r = distance / fall;
  const double along = t.dot(r * out - a);
  if (along >= 0 && along <= length) radius = std::min(radius, r);
  return radius;
}

double first_touch(double length, const PlanePoint& a, const PlanePoint& b) {
  const bool before = std::max(a.x(), b.x()) < 0;
  const bool after = std::min(a.x(), b.x()) > length;
  // Over the edge: the disc under a point at height y has radius y / 2.
  if (!before && !after) return std::max(0.0, std::min(a.y(), b.y()) / 2);
  const PlanePoint end(before ? 0.0 : length, 0.0);
  return touch_radius(PlanePoint(0, 1), a - end, b - end);
}

Cut cut_parallel(double h, const PlanePoint& a, const PlanePoint& b) {
  const double r = h * (1 - equal_share);
  Cut cut;
  for (const PlanePoint& q : {a, b}) {
    const double fall = h - q.y();
    const double square = r * r - fall * fall;
    if (square <= 0) continue;
    const double half = std::sqrt(square);
    cut.add(q.x() - half, q.x() + half);
  }
  const PlanePoint span = b - a;
  const double length = span.norm();
  if (length == 0) return cut;
  const PlanePoint t = span / length;
  // Where |offset + slope x| < limit.
  const auto within = [](double offset, double slope, double low, double high, double& from, double& to) {
    if (slope == 0) {
      if (!(offset > low && offset < high)) to = from;
      return;
    }
    const double x0 = (low - offset) / slope;
    const double x1 = (high - offset) / slope;
    from = std::max(from, std::min(x0, x1));
    to = std::min(to, std::max(x0, x1));
  };
  double from = -never, to = never;
  within(t.x() * (h - a.y()) + t.y() * a.x(), -t.y(), -r, r, from, to);
  within(t.y() * (h - a.y()) - t.x() * a.x(), t.x(), 0, length, from, to);
  cut.add(from, to);
  return cut;
}

namespace {

// Adds (from, to), an angle up to whole turns, where it meets the arc.
void add_turned(ArcCuts& cuts, double from, double to, double half_angle) {
  if (!(from < to)) return;
  for (const double turn : {-2 * M_PI, 0.0, 2 * M_PI})
    if (to + turn > -half_angle && from + turn < half_angle)
      cuts.cuts[cuts.count++] = {from + turn, to + turn};
}

}  // namespace

ArcCuts cut_arc(double h, double half_angle, const PlanePoint& a, const PlanePoint& b) {
  const double r = h * (1 - equal_share);
  ArcCuts cuts;
  for (const PlanePoint& q : {a, b}) {
    const double d = q.norm();
    if (d == 0) continue;
    const double cosine = (d * d + h * h - r * r) / (2 * h * d);
    if (cosine >= 1) continue;
    const double half = std::acos(cosine);
    const double centre = std::atan2(q.x(), q.y());
    add_turned(cuts, centre - half, centre + half, half_angle);
  }
  const PlanePoint span = b - a;
  const double length = span.norm();
  if (length == 0) return cuts;
  const PlanePoint t = span / length;
  PlanePoint normal = quarter_turn(t);
  double distance = normal.dot(a);
  if (distance < 0) {
    normal = -normal;
    distance = -distance;
  }
  // Angles whose foot lies within the segment, on either side of its direction, and not beyond the line by r.
  const double low = t.dot(a) / h;
  const double high = low + length / h;
  if (low >= 1 || high <= -1) return cuts;
  const double near_half = high >= 1 ? 0.0 : std::acos(high);
  const double far_half = low <= -1 ? M_PI : std::acos(low);
  // Seen from the origin the line lies towards `normal`: -normal is the direction away from it, where points
  // are distance + h from the line.
  const double lost_below = (distance - r) / h;  // cosine to `normal` above which a point is within r
  if (lost_below >= 1) return cuts;
  const double lost_half = lost_below <= -1 ? M_PI : std::acos(lost_below);
  const double toward = std::atan2(t.x(), t.y());
  const double centre = std::atan2(normal.x(), normal.y());
  for (const double side : {-1.0, 1.0}) {
    const double from = toward + (side > 0 ? near_half : -far_half);
    const double to = toward + (side > 0 ? far_half : -near_half);
    // The lost angles are centre +- lost_half, up to whole turns.
    for (const double turn : {-2 * M_PI, 0.0, 2 * M_PI})
      add_turned(cuts, std::max(from, centre + turn - lost_half), std::min(to, centre + turn + lost_half),
                 half_angle);
  }
  return cuts;
}

}  // namespace sonoband::flow
