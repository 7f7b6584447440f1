// Rigid and affine transforms between frames. Point: p_to = A p_from + t. Direction: d_to = A d_from.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <optional>

#include "core/geometry/frames.h"

namespace sonoband {

// Affine: may scale (mm per pixel) and shear. Only `inverse` is offered; transposing would be wrong here.
template <class To, class From>
struct Affine {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Point<To> operator*(const Point<From>& p) const { return {linear * p.v + translation}; }
  Direction<To> operator*(const Direction<From>& d) const { return {linear * d.v}; }

  // Undefined for a singular `linear`; whoever reads transforms from outside checks first (see
  // is_invertible).
  Affine<From, To> inverse() const {
    const Eigen::Matrix3d inverse_linear = linear.inverse();
    return {inverse_linear, -(inverse_linear * translation)};
  }
};

// Rotation and translation in mm on both sides: inverts by transposing.
template <class To, class From>
struct Rigid {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Point<To> operator*(const Point<From>& p) const { return {rotation * p.v + translation}; }
  Direction<To> operator*(const Direction<From>& d) const { return {rotation * d.v}; }
  Rigid<From, To> inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  Affine<To, From> affine() const { return {rotation, translation}; }
};

template <class A, class B, class C>
Rigid<A, C> operator*(const Rigid<A, B>& a_from_b, const Rigid<B, C>& b_from_c) {
  return {a_from_b.rotation * b_from_c.rotation,
          a_from_b.rotation * b_from_c.translation + a_from_b.translation};
}
template <class A, class B, class C>
Affine<A, C> operator*(const Affine<A, B>& a_from_b, const Affine<B, C>& b_from_c) {
  return {a_from_b.linear * b_from_c.linear, a_from_b.linear * b_from_c.translation + a_from_b.translation};
}
template <class A, class B, class C>
Affine<A, C> operator*(const Rigid<A, B>& a_from_b, const Affine<B, C>& b_from_c) {
  return a_from_b.affine() * b_from_c;
}
template <class A, class B, class C>
Affine<A, C> operator*(const Affine<A, B>& a_from_b, const Rigid<B, C>& b_from_c) {
  return a_from_b * b_from_c.affine();
}

// Scalar-first quaternion (w, x, y, z) and position to a pose; the quaternion is normalised here.
template <class To, class From>
Rigid<To, From> rigid(const Eigen::Quaterniond& to_from_from, const Eigen::Vector3d& translation) {
  return {to_from_from.normalized().toRotationMatrix(), translation};
}

// Finite, and the volume of the unit cube's image is not vanishing against the lengths of its edges (ratio
// 1e-9).
template <class To, class From>
bool is_invertible(const Affine<To, From>& t) {
  const double edges = t.linear.col(0).norm() * t.linear.col(1).norm() * t.linear.col(2).norm();
  return t.linear.allFinite() && t.translation.allFinite() &&
         std::abs(t.linear.determinant()) > 1e-9 * edges && edges > 0;
}

// Orthogonal within `tolerance` in every entry of R R^T - I, right-handed and finite. Sequence files print 6
// digits, so a true rotation is off by about 1e-5; 1e-3 also admits a pose that was averaged.
bool is_rotation(const Eigen::Matrix3d& m, double tolerance = 1e-3);

}  // namespace sonoband
