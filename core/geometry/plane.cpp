#include "core/geometry/plane.h"

namespace sonoband {

Rigid<frame::World, frame::Plane> ReslicePlane::world_from_plane() const {
  Eigen::Matrix3d axes;
  axes << right.v, down.v, normal().v;
  return {axes, origin.v};
}

std::optional<ReslicePlane> make_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& right,
                                       const Eigen::Vector3d& down, int width, int height, double pixel_mm) {
  if (!origin.allFinite() || !right.allFinite() || !down.allFinite()) return std::nullopt;
  if (right.norm() == 0 || down.norm() == 0) return std::nullopt;
  const Eigen::Vector3d unit_right = right.normalized();
  const Eigen::Vector3d rest = down.normalized() - down.normalized().dot(unit_right) * unit_right;
  // Below 1e-6 (0.2 arc seconds) what is left of `down` is rounding noise, not a direction.
  if (rest.norm() < 1e-6) return std::nullopt;
  return ReslicePlane{{origin}, {unit_right}, {rest.normalized()}, width, height, pixel_mm};
}

}  // namespace sonoband
