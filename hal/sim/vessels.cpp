#include <cmath>

#include "hal/sim/materials.h"
#include "hal/sim/phantom.h"

namespace sonoband::sim {

using Eigen::Vector3f;

namespace {

// A tube through the points, its wall first so that lumens of touching tubes join.
void add_tube(std::vector<Shape>& walls, std::vector<Shape>& lumens, const std::vector<Vector3f>& line,
              float radius, const Flow& flow) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    walls.push_back(capsule(line[i], line[i + 1], radius + 0.45F, tissue::vessel_wall));
    Shape lumen = capsule(line[i], line[i + 1], radius, tissue::blood);
    lumen.flow = flow;
    lumens.push_back(lumen);
  }
}

std::vector<Vector3f> bend(const Vector3f& a, const Vector3f& b, const Vector3f& bulge) {
  std::vector<Vector3f> line;
  constexpr int pieces = 12;
  for (int i = 0; i <= pieces; ++i) {
    const float u = static_cast<float>(i) / pieces;
    line.emplace_back(a + u * (b - a) + std::sin(3.14159265F * u) * bulge);
  }
  return line;
}

}  // namespace

Anatomy vessels() {
  std::vector<Shape> walls;
  std::vector<Shape> lumens;
  const Flow artery{.peak_mm_s = 420, .pulsatility = 0.45F};
  const Flow branch{.peak_mm_s = 360, .pulsatility = 0.45F};
  const Flow vein{.peak_mm_s = -260, .pulsatility = 0.1F};
  // The vein is behind (deeper than) the artery and wider.
  add_tube(walls, lumens, bend({2, 25.5F, -60}, {-1, 27, 60}, {2.5F, 1.5F, 0}), 4.4F, vein);
  // Larger ones later, so that their flow fills the places where they divide.
  add_tube(walls, lumens, bend({8, 19, 30}, {11.5F, 16, 60}, {0.6F, -0.4F, 0}), 1.5F, branch);
  add_tube(walls, lumens, bend({8, 19, 30}, {6.5F, 22, 60}, {0.4F, 0.5F, 0}), 1.5F, branch);
  add_tube(walls, lumens, bend({0, 16.5F, 2}, {-7.5F, 15, 60}, {-2, -1.5F, 0}), 2.2F, branch);
  add_tube(walls, lumens, bend({0, 16.5F, 2}, {8, 19, 30}, {1.5F, 0.5F, 0}), 2.3F, branch);
  add_tube(walls, lumens, bend({0, 17.5F, -60}, {0, 16.5F, 2}, {-1.5F, -1, 0}), 3.1F, artery);

  std::vector<Shape> all;
  all.push_back(slab(-100, -3, tissue::air));
  all.push_back(slab(-3, 0, tissue::gel));
  all.push_back(slab(0, 1.5F, tissue::skin));
  all.push_back(slab(1.5F, 5.5F, tissue::fat));
  all.push_back(slab(5.5F, 5.9F, tissue::fascia));
  all.push_back(ellipsoid({-9, 9.5F, 0}, {10, 3.2F, 90}, tissue::dark_muscle));
  all.push_back(ellipsoid({11, 10, 0}, {9, 2.8F, 90}, tissue::dark_muscle));
  all.push_back(ellipsoid({-16, 19, -10}, {6, 7, 26}, tissue::gland));  // beside the artery
  all.push_back(slab(38, 38.6F, tissue::fascia));
  all.insert(all.end(), walls.begin(), walls.end());
  all.insert(all.end(), lumens.begin(), lumens.end());
  return {tissue::flesh, all, {-40, -30, -75}, {40, 60, 75}, 1};
}

}  // namespace sonoband::sim
