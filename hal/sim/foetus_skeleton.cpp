#include "hal/sim/foetus_skeleton.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sim/materials.h"

namespace sonoband::sim {

using Eigen::Vector3f;

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int cervical = 7;
constexpr int thoracic = 12;
constexpr int vertebrae = cervical + thoracic + 5 + 5;

float vertebra_at(int i) {
  return (static_cast<float>(i) + 0.5F) / vertebrae;
}

// Unit axes of the spine at s: along (towards the feet), ventral, side (x > 0).
struct SpineAxes {
  Vector3f along, ventral, side;
};
SpineAxes spine_axes(float s) {
  const Vector3f along = (spine(std::min(s + 0.02F, 1.0F)) - spine(std::max(s - 0.02F, 0.0F))).normalized();
  const Vector3f side = (Vector3f::UnitX() - along.x() * along).normalized();
  return {along, side.cross(along), side};
}

void add_vertebra(std::vector<Shape>& bones, float s, float size) {
  const Vector3f c = spine(s);
  const SpineAxes at = spine_axes(s);
  Eigen::Matrix3f axes;
  axes << at.side, at.ventral, at.along;
  // Three centres of ossification: the body and the two halves of the arch.
  bones.push_back(ellipsoid(c, Vector3f(1.25F, 0.95F, 0.7F) * size, tissue::bone, axes));
  for (const float side : {-1.0F, 1.0F}) {
    const Vector3f root = c + (side * 1.7F * at.side - 1.5F * at.ventral) * size;
    const Vector3f bend = c + (side * 1.9F * at.side - 2.6F * at.ventral) * size;
    const Vector3f tip = c + (side * 0.8F * at.side - 3.7F * at.ventral + 0.5F * at.along) * size;
    bones.push_back(capsule(root, bend, 0.5F * size, tissue::bone));
    bones.push_back(capsule(bend, tip, 0.4F * size, tissue::bone));
  }
}

void add_rib(std::vector<Shape>& bones, int number, float side) {
  const float s = vertebra_at(cervical + number);
  const SpineAxes at = spine_axes(s);
  const float u = static_cast<float>(number) / (thoracic - 1);
  const float half_width = 8.5F + 5.0F * std::sin(pi * std::min(u + 0.12F, 1.0F) * 0.75F);
  const float reach = 9.5F + 2.5F * std::sin(pi * u);
  const float end = number < 7 ? 2.45F : 2.45F - 0.3F * static_cast<float>(number - 6);
  constexpr int pieces = 9;
  Vector3f last;
  for (int i = 0; i <= pieces; ++i) {
    const float angle = 0.25F + (end - 0.25F) * static_cast<float>(i) / pieces;
    const float forward = reach * (1 - std::cos(angle));
    const Vector3f p = spine(s) + side * half_width * std::sin(angle) * at.side +
                       (forward - 0.8F) * at.ventral + 0.32F * forward * at.along;
    if (i > 0) bones.push_back(capsule(last, p, 0.5F, tissue::thin_bone));
    last = p;
  }
}

void add_face(std::vector<Shape>& bones) {
  for (const float side : {-1.0F, 1.0F}) {
    const auto at = [side](float x, float y, float z) { return Vector3f(side * x, y, z); };
    bones.push_back(ellipsoid(at(5.6F, 30.5F, -23.5F), {2.9F, 2.4F, 2.7F}, tissue::fluid));  // eye
    bones.push_back(capsule(at(8.6F, 32, -26), at(8.8F, 33, -21.5F), 0.5F, tissue::thin_bone));
    bones.push_back(capsule(at(8.8F, 33, -21.5F), at(4, 29.5F, -20), 0.5F, tissue::thin_bone));
    bones.push_back(capsule(at(8.5F, 44, -17), at(7.5F, 42, -12), 0.6F, tissue::thin_bone));  // jaw
    bones.push_back(capsule(at(7.5F, 42, -12), at(4.8F, 33, -10.5F), 0.6F, tissue::thin_bone));
    bones.push_back(capsule(at(4.8F, 33, -10.5F), at(0, 30, -10.5F), 0.6F, tissue::thin_bone));
    bones.push_back(capsule(at(5.8F, 37, -16.5F), at(3.5F, 31, -15.5F), 0.6F, tissue::thin_bone));
    bones.push_back(capsule(at(3.5F, 31, -15.5F), at(0, 29.3F, -15.5F), 0.6F, tissue::thin_bone));
  }
  bones.push_back(capsule({0, 27.6F, -24}, {0, 26.4F, -20.5F}, 0.4F, tissue::thin_bone));  // nose
}

void add_girdles(std::vector<Shape>& bones, int side) {
  const auto at = [side](float x, float y, float z) { return Vector3f(static_cast<float>(side) * x, y, z); };
  bones.push_back(capsule(at(1.8F, 46, -8.5F), at(10, 53, -9), 0.55F, tissue::bone));  // clavicle
  bones.push_back(capsule(at(9.5F, 60, -8), at(7, 67, 1), 0.6F, tissue::thin_bone));   // scapula
  bones.push_back(capsule(at(9.5F, 60, -8), at(10, 65.5F, -2), 0.5F, tissue::thin_bone));
  bones.push_back(capsule(at(10, 65.5F, -2), at(7, 67, 1), 0.5F, tissue::thin_bone));
  // The wing of the ilium: a fan from the joint of the sacrum.
  for (int i = 0; i < 6; ++i) {
    const float u = static_cast<float>(i) / 5;
    bones.push_back(capsule(at(3.6F, 61.5F, 28.5F), at(5.5F + 3 * u, 66 - 9.5F * u, 23.5F + 1.5F * u * u),
                            0.55F, tissue::bone));
  }
  bones.push_back(capsule(at(4.2F, 62, 32), at(3, 58.5F, 35), 0.7F, tissue::bone));  // ischium
}

void add_digits(std::vector<Shape>& bones, const std::vector<Digit>& digits) {
  constexpr std::array<float, 4> radius{0.6F, 0.52F, 0.46F, 0.42F};
  for (const Digit& d : digits) {
    for (std::size_t i = 0; i < radius.size(); ++i) {
      // Joints are gristle: bones end 0.4 mm short of them.
      const Vector3f axis = (d.joint[i + 1] - d.joint[i]).normalized();
      const Vector3f trim = (radius[i] + 0.35F) * axis;
      bones.push_back(capsule(d.joint[i] + trim, d.joint[i + 1] - trim, radius[i], tissue::bone));
    }
  }
}

void add_limbs(std::vector<Shape>& bones, int side) {
  const Limbs l = limbs(side);
  const auto shaft = [&](const Vector3f& from, const Vector3f& to, float radius, const Vector3f& aside) {
    const Vector3f axis = (to - from).normalized();
    const Vector3f a = from + 2.0F * axis + aside;
    const Vector3f b = to - 2.0F * axis + aside;
    bones.push_back(capsule(a, b, radius, tissue::bone));
    bones.push_back(cone(a, radius + 0.45F, a + 2.2F * axis, radius, tissue::bone));
    bones.push_back(cone(b, radius + 0.45F, b - 2.2F * axis, radius, tissue::bone));
  };
  const float x = static_cast<float>(side);
  shaft(l.shoulder, l.elbow, 0.95F, Vector3f::Zero());
  shaft(l.elbow, l.wrist, 0.65F, Vector3f(0.9F * x, 0.4F, 0.5F));
  shaft(l.elbow, l.wrist, 0.65F, Vector3f(-0.9F * x, -0.4F, -0.5F));
  shaft(l.hip, l.knee, 1.1F, Vector3f::Zero());
  shaft(l.knee, l.ankle, 0.9F, Vector3f(-0.8F * x, 0, 0));
  shaft(l.knee, l.ankle, 0.55F, Vector3f(1.4F * x, 0.7F, 0));
  bones.push_back(ellipsoid(l.heel, {1.3F, 1.4F, 1.2F}, tissue::bone));
  add_digits(bones, fingers(side));
  add_digits(bones, foot_rays(side));
}

// Five rays that leave `root` around `forward`, fanned out along `across` and bent along `bend`.
std::vector<Digit> fan(const Vector3f& root, const Vector3f& forward, const Vector3f& across,
                       const Vector3f& bend, const std::array<std::array<float, 4>, 5>& lengths,
                       const std::array<float, 5>& splay, const std::array<float, 5>& curl) {
  std::vector<Digit> rays;
  for (std::size_t i = 0; i < 5; ++i) {
    Digit d;
    const float c = std::cos(splay[i]);
    const float s = std::sin(splay[i]);
    const Vector3f out = c * forward + s * across;
    d.joint[0] = root + 1.6F * out + 1.3F * s * across;
    for (std::size_t k = 0; k < 4; ++k) {
      const float turn = curl[i] * (static_cast<float>(k) - 0.6F);
      const Vector3f direction = std::cos(turn) * out + std::sin(turn) * bend;
      d.joint[k + 1] = d.joint[k] + lengths[i][k] * direction;
    }
    rays.push_back(d);
  }
  return rays;
}

}  // namespace

Vector3f spine(float s) {
  // Cubic through (y, z) of skull, C7, T6, T12, L5 and the sacrum's tip (Catmull-Rom).
  constexpr std::array<std::array<float, 2>, 8> knots{
      {{54, -24}, {58, -19}, {65, -10}, {70, 2}, {71, 14}, {67, 25}, {59, 32.5F}, {54, 35}}};
  const float t = std::clamp(s, 0.0F, 1.0F) * 4.999F;
  const auto i = static_cast<std::size_t>(t);
  const float u = t - static_cast<float>(i);
  const auto blend = [&](std::size_t c) {
    const float p0 = knots[i][c];
    const float p1 = knots[i + 1][c];
    const float p2 = knots[i + 2][c];
    const float p3 = knots[i + 3][c];
    return 0.5F * (2 * p1 + (p2 - p0) * u + (2 * p0 - 5 * p1 + 4 * p2 - p3) * u * u +
                   (3 * p1 - p0 - 3 * p2 + p3) * u * u * u);
  };
  return {3.0F * std::sin(8.0F * s + 0.6F), blend(0), blend(1)};
}

Limbs limbs(int side) {
  const auto x = static_cast<float>(side);
  // A little different on each side: nobody lies in perfect symmetry.
  const float d = side > 0 ? 1.0F : -1.0F;
  return {.shoulder = {11 * x, 55, -7},
          .elbow = {16 * x, 46 + d, 6 + d},
          .wrist = {(9 - d) * x, 34 + d, -4 + 2 * d},
          .hip = {5.5F * x, 56.5F, 30},
          .knee = {(6.3F + 0.6F * d) * x, 37.5F + d, 31 + 1.2F * d},
          .ankle = {(4.2F - 0.7F * d) * x, 43 + d, 46 + 0.6F * d},
          .heel = {(4.2F - 0.7F * d) * x, 45.5F + d, 47.5F + 0.6F * d},
          .toes = {(4.4F - 0.3F * d) * x, 33 + d, 47.5F + 0.4F * d}};
}

std::vector<Digit> fingers(int side) {
  const auto x = static_cast<float>(side);
  const Limbs l = limbs(side);
  const Vector3f forward = Vector3f(-0.05F * x, -0.78F, -0.62F).normalized();
  const Vector3f across = (Vector3f(x, 0, 0) - x * forward.x() * forward).normalized();
  const Vector3f bend = forward.cross(across).normalized();
  // Thumb first, towards the mid-line. The open hand (x < 0) is spread, the other half closed.
  const std::array<float, 5> splay{-0.75F, -0.3F, -0.05F, 0.2F, 0.45F};
  const std::array<float, 5> open{0.3F, -0.22F, 0.18F, -0.25F, 0.3F};
  const std::array<float, 5> closed{0.5F, 0.75F, 0.8F, 0.8F, 0.75F};
  return fan(l.wrist, forward, across, bend,
             {{{3.4F, 3.0F, 2.4F, 0.9F},
               {5.2F, 3.9F, 2.7F, 2.2F},
               {5.2F, 4.3F, 3.0F, 2.3F},
               {4.9F, 4.0F, 2.8F, 2.2F},
               {4.5F, 3.2F, 2.2F, 2.0F}}},
             splay, side < 0 ? open : closed);
}

std::vector<Digit> foot_rays(int side) {
  const auto x = static_cast<float>(side);
  const Limbs l = limbs(side);
  const Vector3f forward = (l.toes - l.heel).normalized();
  const Vector3f across = (Vector3f(x, 0, 0) - x * forward.x() * forward).normalized();
  const Vector3f bend = forward.cross(across) * x;
  return fan(l.heel + 1.5F * forward, forward, across, bend,
             {{{5.0F, 3.0F, 1.9F, 0.9F},
               {5.2F, 2.4F, 1.5F, 1.2F},
               {5.0F, 2.2F, 1.4F, 1.2F},
               {4.8F, 2.0F, 1.3F, 1.1F},
               {4.5F, 1.8F, 1.2F, 1.0F}}},
             {-0.26F, -0.12F, 0.0F, 0.12F, 0.26F}, {0.1F, 0.12F, 0.14F, 0.16F, 0.18F});
}

Shape skull_vault() {
  return ellipsoid({0, 48, -31}, {16, 20, 17}, tissue::skull);
}

std::vector<Shape> other_bones() {
  std::vector<Shape> bones;
  add_face(bones);
  for (int i = 0; i < vertebrae; ++i) {
    const float size = i < cervical ? 0.75F : i < cervical + thoracic + 5 ? 1.0F : 0.8F;
    add_vertebra(bones, vertebra_at(i), size);
  }
  for (int i = 0; i < thoracic; ++i) {
    add_rib(bones, i, -1);
    add_rib(bones, i, 1);
  }
  for (const int side : {-1, 1}) {
    add_girdles(bones, side);
    add_limbs(bones, side);
  }
  return bones;
}

}  // namespace sonoband::sim
