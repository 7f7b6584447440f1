// The bones of the foetus phantom; frame Phantom, see phantom.h.
#pragma once

#include <vector>

#include "hal/sim/shapes.h"

namespace sonoband::sim {

// Joints that bones and flesh share. `side` is -1 (x < 0) or +1.
struct Limbs {
  Eigen::Vector3f shoulder, elbow, wrist, hip, knee, ankle, heel, toes;
};
Limbs limbs(int side);

// Point of the spine, s from 0 (skull) to 1 (tip of the sacrum): it bends in the plane x = 0 and weaves
// 3 mm across it.
Eigen::Vector3f spine(float s);

// The four segments of each of the five digits, from the wrist (or heel) outward.
struct Digit {
  Eigen::Vector3f joint[5];
};
std::vector<Digit> fingers(int side);
std::vector<Digit> foot_rays(int side);

// The vault of the skull, solid: the brain goes inside it. All other bones go over both.
Shape skull_vault();
std::vector<Shape> other_bones();

}  // namespace sonoband::sim
