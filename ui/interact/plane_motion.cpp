#include "ui/interact/plane_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "ui/interact/cross.h"

namespace sonoband::ui {
namespace {

// After thousands of small turns the axes must still be unit and square.
ReslicePlane squared(ReslicePlane plane) {
  plane.right.v.normalize();
  plane.down.v = (plane.down.v - plane.right.v.dot(plane.down.v) * plane.right.v).normalized();
  return plane;
}

}  // namespace

ReslicePlane moved(const ReslicePlane& plane, const Eigen::Vector2d& by_mm) {
  ReslicePlane out = plane;
  out.origin.v -= by_mm.x() * plane.right.v + by_mm.y() * plane.down.v;
  return out;
}

ReslicePlane zoomed(const ReslicePlane& plane, double factor, const Eigen::Vector2d& about_mm) {
  constexpr double finest_mm = 0.02;
  constexpr double coarsest_mm = 2;
  if (!(factor > 0)) return plane;
  ReslicePlane out = plane;
  out.pixel_mm = std::clamp(plane.pixel_mm / factor, std::min(finest_mm, plane.pixel_mm),
                            std::max(coarsest_mm, plane.pixel_mm));
  const double kept = 1 - out.pixel_mm / plane.pixel_mm;
  out.origin.v += kept * (about_mm.x() * plane.right.v + about_mm.y() * plane.down.v);
  return out;
}

ReslicePlane turned(const ReslicePlane& plane, double by_rad, const Eigen::Vector2d& about_mm) {
  const double c = std::cos(by_rad);
  const double s = std::sin(by_rad);
  const Eigen::Vector3d about = from_plane(plane, about_mm);
  ReslicePlane out = plane;
  out.right.v = c * plane.right.v - s * plane.down.v;
  out.down.v = s * plane.right.v + c * plane.down.v;
  out = squared(out);
  out.origin.v = about - about_mm.x() * out.right.v - about_mm.y() * out.down.v;
  return out;
}

ReslicePlane shaped(const ReslicePlane& plane, int width, int height, double width_per_height) {
  ReslicePlane out = plane;
  out.width = std::max(width, static_cast<int>(std::lround(height * width_per_height)));
  out.height = std::max(height, static_cast<int>(std::lround(width / width_per_height)));
  out.origin.v += 0.5 * plane.pixel_mm *
                  ((plane.width - out.width) * plane.right.v + (plane.height - out.height) * plane.down.v);
  return out;
}

ReslicePlane carried(const ReslicePlane& plane, const ReslicePlane& from, const ReslicePlane& to) {
  const auto axes = [](const ReslicePlane& p) {
    Eigen::Matrix3d m;
    m << p.right.v, p.down.v, p.normal().v;
    return m;
  };
  const Eigen::Matrix3d turn = axes(to) * axes(from).transpose();
  ReslicePlane out = plane;
  out.right.v = turn * plane.right.v;
  out.down.v = turn * plane.down.v;
  out = squared(out);
  out.origin.v = to.origin.v + turn * (plane.origin.v - from.origin.v);
  return out;
}

ReslicePlane pushed(const ReslicePlane& plane, double by_mm) {
  ReslicePlane out = plane;
  out.origin.v += by_mm * plane.normal().v;
  return out;
}

ReslicePlane tilted(const ReslicePlane& plane, double about_right_rad, double about_down_rad,
                    const Eigen::Vector2d& about_mm) {
  const Eigen::Vector3d about = from_plane(plane, about_mm);
  ReslicePlane out = plane;
  out.down.v = Eigen::AngleAxisd(about_right_rad, out.right.v) * out.down.v;
  out.right.v = Eigen::AngleAxisd(about_down_rad, out.down.v) * out.right.v;
  out = squared(out);
  out.origin.v = about - about_mm.x() * out.right.v - about_mm.y() * out.down.v;
  return out;
}

}  // namespace sonoband::ui
