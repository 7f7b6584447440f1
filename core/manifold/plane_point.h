// Points of a reslice plane, and the little plane geometry that curves need.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace sonoband {

// x along the plane's right, y along its down; mm from the origin pixel unless the name says px.
using PlanePoint = Eigen::Vector2d;
using PlaneLine = std::vector<PlanePoint>;  // an open polyline; one that closes repeats its first point

inline double cross(const PlanePoint& a, const PlanePoint& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// A quarter turn from right towards down. Of a direction of travel e it is n x e, n = right x down being the
// plane's normal: the side of the positive layers (see flow.h).
inline PlanePoint quarter_turn(const PlanePoint& e) {
  return {-e.y(), e.x()};
}

inline PlanePoint nearest_on_segment(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
  const PlanePoint ab = b - a;
  const double squared = ab.squaredNorm();
  if (squared == 0) return a;
  return a + std::clamp((p - a).dot(ab) / squared, 0.0, 1.0) * ab;
}

inline double distance_to_segment(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
  return (p - nearest_on_segment(p, a, b)).norm();
}

}  // namespace sonoband
