#include "ui/interact/cross.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace sonoband::ui {

bool clip_line(Eigen::Vector2d& a, Eigen::Vector2d& b, double left, double top, double right, double bottom) {
  // Liang and Barsky: the part of a + t (b - a), 0 <= t <= 1, that is inside all four edges.
  const Eigen::Vector2d d = b - a;
  double from = 0;
  double to = 1;
  const std::array<std::pair<double, double>, 4> edges = {
      {{-d.x(), a.x() - left}, {d.x(), right - a.x()}, {-d.y(), a.y() - top}, {d.y(), bottom - a.y()}}};
  for (const auto& [p, q] : edges) {
    if (p == 0) {
      if (q < 0) return false;
    } else if (p < 0) {
      from = std::max(from, q / p);
    } else {
      to = std::min(to, q / p);
    }
  }
  if (from > to) return false;
  b = a + to * d;
  a = a + from * d;
  return true;
}

std::optional<Crossing> crossing(const TrackedFrame& f, const ReslicePlane& plane) {
  const Eigen::Vector3d n = plane.normal().v;
  // Signed distance of pixel (x, y) from the plane: g . (x, y) + h.
  const Eigen::Vector2d g(n.dot(f.world_from_image.linear.col(0)), n.dot(f.world_from_image.linear.col(1)));
  const double h = n.dot(f.world_from_image.translation - plane.origin.v);
  const double size = g.norm();
  const double column = f.world_from_image.linear.col(0).norm();
  if (size < 1e-9 * column) return std::nullopt;
  const int width = f.bscan.pixels.width;
  const int height = f.bscan.pixels.height;
  const Eigen::Vector2d foot = -h / (size * size) * g;
  const Eigen::Vector2d along(-g.y() / size, g.x() / size);
  const double far = foot.norm() + width + height;
  Crossing c;
  Eigen::Vector2d a = foot - far * along;
  Eigen::Vector2d b = foot + far * along;
  if (!clip_line(a, b, -0.5, -0.5, width - 0.5, height - 0.5)) return std::nullopt;
  c.image_px = {a, b};
  for (int i = 0; i < 2; ++i) c.plane_mm[i] = on_plane(plane, from_image(f, c.image_px[i])).mm;
  return c;
}

OnPlane on_plane(const ReslicePlane& plane, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d d = p_world - plane.origin.v;
  return {{d.dot(plane.right.v), d.dot(plane.down.v)}, d.dot(plane.normal().v)};
}

Eigen::Vector3d from_plane(const ReslicePlane& plane, const Eigen::Vector2d& mm) {
  return plane.origin.v + mm.x() * plane.right.v + mm.y() * plane.down.v;
}

OnImage on_image(const TrackedFrame& f, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p = (f.image_from_world * Point<frame::World>{p_world}).v;
  return {{p.x(), p.y()}, p.z()};
}

Eigen::Vector3d from_image(const TrackedFrame& f, const Eigen::Vector2d& px) {
  return (f.world_from_image * Point<frame::Image>{{px.x(), px.y(), 0}}).v;
}

}  // namespace sonoband::ui
