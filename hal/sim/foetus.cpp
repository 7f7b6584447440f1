#include <Eigen/Geometry>

#include "hal/sim/foetus_skeleton.h"
#include "hal/sim/materials.h"
#include "hal/sim/phantom.h"

namespace sonoband::sim {

using Eigen::Vector3f;

namespace {

// The mother's belly, the womb and its water.
void add_surroundings(std::vector<Shape>& all) {
  all.push_back(slab(-100, -3, tissue::air));
  all.push_back(slab(-3, 0, tissue::gel));
  all.push_back(slab(0, 1.4F, tissue::skin));
  all.push_back(slab(1.4F, 4.2F, tissue::fat));
  all.push_back(slab(4.2F, 4.6F, tissue::fascia));
  all.push_back(slab(4.6F, 7.2F, tissue::muscle));
  all.push_back(slab(7.2F, 7.5F, tissue::fascia));
  all.push_back(ellipsoid({0, 51, 0}, {50, 43, 66}, tissue::uterus));
  all.push_back(ellipsoid({0, 51, 0}, {45, 39, 61}, tissue::fluid));
  const Eigen::Matrix3f turned = Eigen::AngleAxisf(0.45F, Vector3f::UnitZ()).toRotationMatrix();
  all.push_back(ellipsoid({-27, 83, 8}, {27, 9, 36}, tissue::placenta, turned));
}

void add_flesh(std::vector<Shape>& all) {
  using tissue::flesh;
  all.push_back(ellipsoid({0, 48, -31}, {17.6F, 21.8F, 18.6F}, tissue::scalp));
  all.push_back(ellipsoid({0, 38, -18}, {10.5F, 12.5F, 10}, flesh));  // face
  all.push_back(cone({0, 52, -18}, 9, {0, 58, -6}, 10.5F, flesh));    // neck
  all.push_back(ellipsoid({0, 58, 0}, {15, 17.5F, 20}, flesh));
  all.push_back(ellipsoid({0, 57.5F, 17}, {16.5F, 17.5F, 19}, flesh));
  all.push_back(ellipsoid({0, 60, 29}, {11.5F, 12.5F, 10}, flesh));
  for (const int side : {-1, 1}) {
    const Limbs l = limbs(side);
    all.push_back(cone(l.shoulder, 4, l.elbow, 2.9F, flesh));
    all.push_back(cone(l.elbow, 2.9F, l.wrist, 2.3F, flesh));
    all.push_back(cone(l.hip, 5.4F, l.knee, 3.9F, flesh));
    all.push_back(cone(l.knee, 3.7F, l.ankle, 2.6F, flesh));
    all.push_back(cone(l.heel, 2.6F, l.toes, 1.8F, flesh));
    for (const Digit& d : fingers(side)) {
      for (int i = 0; i < 4; ++i) all.push_back(capsule(d.joint[i], d.joint[i + 1], 1.15F, flesh));
    }
    for (const Digit& d : foot_rays(side)) {
      for (int i = 0; i < 4; ++i) all.push_back(capsule(d.joint[i], d.joint[i + 1], 1.2F, flesh));
    }
    for (const Vector3f& joint : {l.shoulder, l.elbow, l.hip, l.knee, l.ankle}) {
      all.push_back(ellipsoid(joint, {1.9F, 1.9F, 1.9F}, tissue::gristle));
    }
  }
}

void add_organs(std::vector<Shape>& all) {
  for (const float x : {-1.0F, 1.0F}) {
    all.push_back(ellipsoid({7 * x, 59, 1}, {5, 9.5F, 11}, tissue::lung));
    all.push_back(ellipsoid({6 * x, 65, 20}, {2.9F, 2.9F, 4.8F}, tissue::kidney));
    all.push_back(ellipsoid({5.6F * x, 64.5F, 20}, {0.8F, 1, 1.8F}, tissue::fluid));
  }
  const Eigen::Matrix3f lying = Eigen::AngleAxisf(0.6F, Vector3f::UnitZ()).toRotationMatrix();
  all.push_back(ellipsoid({-2.5F, 52, 0}, {5.6F, 7.2F, 6.2F}, tissue::heart, lying));
  for (const float x : {-1.0F, 1.0F}) {
    for (const float y : {-1.0F, 1.0F}) {
      const Vector3f offset = lying * Vector3f(2.2F * x, y > 0 ? 3.2F : -2.2F, 0);
      all.push_back(
          ellipsoid(Vector3f(-2.5F, 52, 0) + offset, {1.6F, y > 0 ? 1.8F : 3, 3.2F}, tissue::blood, lying));
    }
  }
  all.push_back(ellipsoid({4, 52, 14}, {10.5F, 9.5F, 7.5F}, tissue::liver));
  all.push_back(ellipsoid({-7.5F, 56.5F, 13}, {3, 4, 4.5F}, tissue::fluid));    // stomach
  all.push_back(ellipsoid({0, 51.5F, 28.5F}, {2.4F, 2.6F, 3}, tissue::fluid));  // bladder
}

void add_brain(std::vector<Shape>& all) {
  const Eigen::Matrix3f askew = Eigen::AngleAxisf(0.05F, Vector3f::UnitY()).toRotationMatrix();
  all.push_back(ellipsoid({0, 48, -31}, {15.3F, 19.3F, 16.3F}, tissue::brain));
  for (const float x : {-1.0F, 1.0F}) {
    all.push_back(ellipsoid({5.8F * x, 50, -34}, {3.6F, 11, 4.6F}, tissue::fluid));
    all.push_back(ellipsoid({6 * x, 53, -34}, {2.3F, 6.5F, 3.2F}, tissue::choroid));
    all.push_back(ellipsoid({4 * x, 59, -22.5F}, {3.8F, 3.6F, 3.6F}, tissue::cerebellum));
  }
  all.push_back(ellipsoid({0.4F, 47, -33}, {0.3F, 16.5F, 12.5F}, tissue::falx, askew));
}

void add_cord(std::vector<Shape>& all) {
  const std::vector<Vector3f> middle{{0, 42, 23},   {2, 34, 20},   {-5, 27.5F, 12}, {-14, 26, 20},
                                     {-22, 34, 29}, {-28, 48, 30}, {-27, 62, 25},   {-24, 75, 18}};
  constexpr int steps = 10;
  const auto at = [&](float t) {
    const auto last = middle.size() - 1;
    const auto i = std::min(static_cast<std::size_t>(t), last - 1);
    const float u = t - static_cast<float>(i);
    const Vector3f& p0 = middle[i > 0 ? i - 1 : 0];
    const Vector3f& p3 = middle[std::min(i + 2, last)];
    const Vector3f& p1 = middle[i];
    const Vector3f& p2 = middle[i + 1];
    return Vector3f(0.5F * (2 * p1 + (p2 - p0) * u + (2 * p0 - 5 * p1 + 4 * p2 - p3) * u * u +
                            (3 * p1 - p0 - 3 * p2 + p3) * u * u * u));
  };
  const int count = static_cast<int>(middle.size() - 1) * steps;
  const auto along = [&](float turn, float off, float radius, const Material& m, const Flow& flow) {
    Vector3f last;
    for (int i = 0; i <= count; ++i) {
      const float t = static_cast<float>(i) / steps;
      // A turn of the helix every 9 mm or so.
      const float phase = 5.5F * t + turn;
      const Vector3f p = at(t) + off * Vector3f(std::cos(phase), 0.5F * std::sin(phase), std::sin(phase));
      if (i > 0) {
        Shape s = capsule(last, p, radius, m);
        s.flow = flow;
        all.push_back(s);
      }
      last = p;
    }
  };
  along(0, 0, 3, tissue::jelly, {});
  along(0, 1.1F, 1.15F, tissue::blood, {.peak_mm_s = -150, .pulsatility = 0.05F});
  along(2.4F, 1.4F, 0.7F, tissue::blood, {.peak_mm_s = 260, .pulsatility = 0.6F});
  along(3.9F, 1.4F, 0.7F, tissue::blood, {.peak_mm_s = 260, .pulsatility = 0.6F});
}

}  // namespace

Anatomy foetus() {
  std::vector<Shape> all;
  add_surroundings(all);
  add_cord(all);
  add_flesh(all);
  add_organs(all);
  all.push_back(skull_vault());
  add_brain(all);
  const std::vector<Shape> bones = other_bones();
  all.insert(all.end(), bones.begin(), bones.end());
  return {tissue::belly, all, {-80, -30, -80}, {80, 110, 80}};
}

std::vector<Eigen::Vector2d> foetus_curve() {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= 19; ++i) {
    const Vector3f p = spine(static_cast<float>(i) / 20);
    points.emplace_back(p.y(), p.z());
  }
  const Limbs a = limbs(-1);
  const Limbs b = limbs(1);
  const auto add = [&](const Vector3f& p, const Vector3f& q) {
    points.emplace_back((p.y() + q.y()) / 2, (p.z() + q.z()) / 2);
  };
  add(a.hip, b.hip);
  add((a.hip + a.knee) / 2, (b.hip + b.knee) / 2);
  add(a.knee, b.knee);
  add((a.knee + a.ankle) / 2, (b.knee + b.ankle) / 2);
  add(a.ankle, b.ankle);
  add((a.heel + a.toes) / 2, (b.heel + b.toes) / 2);
  add(a.toes, b.toes);
  return points;
}

}  // namespace sonoband::sim
