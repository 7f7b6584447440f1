// The solids that phantoms are made of, as signed distances: negative inside, mm, frame Phantom.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace sonoband::sim {

// How a tissue answers ultrasound.
struct Material {
  float echo_db = 0;     // backscatter against ossified bone, which is 0; fluid is below -60
  float loss_db_mm = 0;  // there and back, beyond what the scanner's depth gain makes up for
  float specular = 0;    // how much of the echo needs the beam to meet the surface squarely: 0 none, 1 all
  bool bone = false;
};

// Flow within a shape: a parabolic profile over a capsule's radius that beats with the heart.
struct Flow {
  float peak_mm_s = 0;    // signed: towards the probe is positive and red; 0 is no flow
  float pulsatility = 0;  // 0 steady (vein) to 1 (stops between beats)
};

struct Shape {
  enum class Kind : std::uint8_t {
    capsule,    // all points within `radius` of the segment a-b
    cone,       // ball of `radius` at a, of `radius_b` at b, and what a sphere rolling between sweeps
    ellipsoid,  // centre a, half axes along the columns of `axes`
    slab,       // a.y <= y <= b.y, without end
  };
  Kind kind = Kind::capsule;
  Eigen::Vector3f a = Eigen::Vector3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  float radius = 0;
  float radius_b = 0;
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();     // ellipsoid: columns are its half axes
  Eigen::Matrix3f to_unit = Eigen::Matrix3f::Identity();  // ellipsoid: inverse of axes
  Material material;
  Flow flow;

  bool contains(const Eigen::Vector3f& p) const;
  // Exact for capsule, cone and slab. For an ellipsoid a bound: right sign, never farther than the truth.
  float distance(const Eigen::Vector3f& p) const;
  // Outward unit normal of the surface nearest to p.
  Eigen::Vector3f normal(const Eigen::Vector3f& p) const;
  // Signed flow at a point inside, mm/s; `beat` is 1 at the top of the pulse and 0 between.
  float velocity(const Eigen::Vector3f& p, float beat) const;
  // Corners of a box that holds it.
  void bounds(Eigen::Vector3f& low, Eigen::Vector3f& high) const;
};

Shape capsule(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float radius, const Material& m);
Shape cone(const Eigen::Vector3f& a, float radius_a, const Eigen::Vector3f& b, float radius_b,
           const Material& m);
// Half axes `half` along the columns of `rotation`.
Shape ellipsoid(const Eigen::Vector3f& centre, const Eigen::Vector3f& half, const Material& m,
                const Eigen::Matrix3f& rotation = Eigen::Matrix3f::Identity());
Shape slab(float y_from, float y_to, const Material& m);

}  // namespace sonoband::sim
