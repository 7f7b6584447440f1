// What lies under the simulated probe.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/geometry/plane.h"
#include "hal/sim/anatomy.h"
#include "hal/sim/frames.h"

namespace sonoband::sim {

// A picture in closed form: the grey of a pixel is this of its centre, in mm of frame Phantom, rounded and
// limited to 0..255. No speckle, beam or shadow, so a test can work out every pixel of every rendering.
struct GreyField {
  std::function<double(const Eigen::Vector3d& p_phantom)> grey;
};

using Phantom = std::variant<GreyField, Anatomy>;

GreyField constant(double grey);

// grey = at_origin + gradient . p
GreyField ramp(double at_origin, const Eigen::Vector3d& gradient_per_mm);

// Bright lines without end on grey 20: 20 + 230 exp(-d^2 / 2 sigma^2), d the distance to the nearest one.
struct Wire {
  Eigen::Vector3d point;
  Eigen::Vector3d direction;  // unit
};
GreyField wires(std::vector<Wire> all, double sigma_mm = 0.4);
// Nine wires, three N's of which one below the other as in calibration phantoms, 20 to 60 mm deep; and two
// wires straight along the sweep.
std::vector<Wire> n_wires();

struct Ball {
  Eigen::Vector3d centre;
  double radius_mm;
  double grey;
};
// Balls with sharp edges; where they overlap the later one counts.
GreyField spheres(std::vector<Ball> all, double background = 30);
std::vector<Ball> ball_rack();

// A foetus of about 16 weeks, curled, on its back, head at z < 0, in its amniotic fluid under the mother's
// belly; spine and legs lie near the plane x = 0 and weave across it by a few mm. It fits z -50..50 and y
// 12..88.
Anatomy foetus();
// Its mid-line for the paper's curve: neck, spine, pelvis, femur, knee, tibia, heel, toes; points (y, z) of
// the plane x = 0 in mm.
std::vector<Eigen::Vector2d> foetus_curve();

// An artery that divides twice, running along z 12 to 26 mm deep, and a vein behind it.
Anatomy vessels();

}  // namespace sonoband::sim
