#include "hal/sim/shapes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sonoband::sim {

using Eigen::Vector3f;

namespace {

// Foot of p on the segment a-b.
Vector3f foot(const Vector3f& a, const Vector3f& b, const Vector3f& p) {
  const Vector3f ab = b - a;
  const float length2 = ab.squaredNorm();
  const float h = length2 > 0 ? std::clamp((p - a).dot(ab) / length2, 0.0F, 1.0F) : 0.0F;
  return a + h * ab;
}

// Where on the axis a-b the ball that is nearest to p rolls, 0 to 1: the radial direction leans by the
// slope of the cone's side.
float cone_foot(const Shape& s, const Vector3f& p) {
  const Vector3f ab = s.b - s.a;
  const float length = ab.norm();
  if (length <= std::abs(s.radius - s.radius_b)) return s.radius >= s.radius_b ? 0.0F : 1.0F;
  const Vector3f axis = ab / length;
  const Vector3f ap = p - s.a;
  const float along = ap.dot(axis);
  const float across = (ap - along * axis).norm();
  const float sine = (s.radius - s.radius_b) / length;
  const float cosine = std::sqrt(1 - sine * sine);
  return std::clamp((along - across * sine / cosine) / length, 0.0F, 1.0F);
}

}  // namespace

bool Shape::contains(const Vector3f& p) const {
  switch (kind) {
    case Kind::capsule:
      return (p - foot(a, b, p)).squaredNorm() <= radius * radius;
    case Kind::ellipsoid:
      return (to_unit * (p - a)).squaredNorm() <= 1;
    case Kind::slab:
      return p.y() >= a.y() && p.y() <= b.y();
    case Kind::cone:
      return distance(p) <= 0;
  }
  return false;
}

float Shape::distance(const Vector3f& p) const {
  switch (kind) {
    case Kind::capsule:
      return (p - foot(a, b, p)).norm() - radius;
    case Kind::cone: {
      const float h = cone_foot(*this, p);
      return (p - (a + h * (b - a))).norm() - (radius + h * (radius_b - radius));
    }
    case Kind::ellipsoid: {
      const float shortest = axes.colwise().norm().minCoeff();
      return ((to_unit * (p - a)).norm() - 1) * shortest;
    }
    case Kind::slab:
      return std::max(a.y() - p.y(), p.y() - b.y());
  }
  return std::numeric_limits<float>::infinity();
}

Vector3f Shape::normal(const Vector3f& p) const {
  Vector3f n = Vector3f::UnitY();
  switch (kind) {
    case Kind::capsule:
      n = p - foot(a, b, p);
      break;
    case Kind::cone:
      n = p - (a + cone_foot(*this, p) * (b - a));
      break;
    case Kind::ellipsoid:
      n = to_unit.transpose() * (to_unit * (p - a));
      break;
    case Kind::slab:
      break;
  }
  const float length = n.norm();
  return length > 0 ? Vector3f(n / length) : Vector3f::UnitY();
}

float Shape::velocity(const Vector3f& p, float beat) const {
  if (flow.peak_mm_s == 0) return 0;
  // From the axis, not the segment, so that tubes made of many pieces show no seams.
  const Vector3f axis = (b - a).normalized();
  const float rho2 = axis.cross(p - a).squaredNorm() / (radius * radius);
  return flow.peak_mm_s * (1 - flow.pulsatility * (1 - beat)) * std::max(0.0F, 1 - rho2);
}

void Shape::bounds(Vector3f& low, Vector3f& high) const {
  switch (kind) {
    case Kind::capsule:
    case Kind::cone: {
      const float rb = kind == Kind::cone ? radius_b : radius;
      low = (a.array() - radius).min(b.array() - rb);
      high = (a.array() + radius).max(b.array() + rb);
      break;
    }
    case Kind::ellipsoid: {
      const Vector3f half = axes.rowwise().norm();
      low = a - half;
      high = a + half;
      break;
    }
    case Kind::slab: {
      constexpr float far = 1e6F;
      low = Vector3f(-far, a.y(), -far);
      high = Vector3f(far, b.y(), far);
      break;
    }
  }
}

Shape capsule(const Vector3f& a, const Vector3f& b, float radius, const Material& m) {
  Shape s;
  s.a = a;
  s.b = b;
  s.radius = s.radius_b = radius;
  s.material = m;
  return s;
}

Shape cone(const Vector3f& a, float radius_a, const Vector3f& b, float radius_b, const Material& m) {
  Shape s = capsule(a, b, radius_a, m);
  s.kind = Shape::Kind::cone;
  s.radius_b = radius_b;
  return s;
}

Shape ellipsoid(const Vector3f& centre, const Vector3f& half, const Material& m,
                const Eigen::Matrix3f& rotation) {
  Shape s;
  s.kind = Shape::Kind::ellipsoid;
  s.a = centre;
  s.axes = rotation * half.asDiagonal();
  s.to_unit = s.axes.inverse();
  s.material = m;
  return s;
}

Shape slab(float y_from, float y_to, const Material& m) {
  Shape s;
  s.kind = Shape::Kind::slab;
  s.a = Vector3f(0, y_from, 0);
  s.b = Vector3f(0, y_to, 0);
  s.material = m;
  return s;
}

}  // namespace sonoband::sim
