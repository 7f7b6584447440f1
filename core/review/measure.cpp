#include "core/review/measure.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace sonoband {

double distance_mm(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (b - a).norm();
}

double path_mm(std::span<const Eigen::Vector3d> points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += distance_mm(points[i - 1], points[i]);
  return sum;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& corner, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - corner;
  const Eigen::Vector3d v = b - corner;
  // atan2 keeps its digits at 0 and 180, where acos of the scalar product loses half of them.
  return std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi;
}

double area_mm2(std::span<const Eigen::Vector3d> polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  }
  return sum.norm() / 2;
}

}  // namespace sonoband
