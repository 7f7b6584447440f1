// Random but legal input for the kernels: crossing frames, overlaps, several sweeps, reversed motion, fans,
// masks with an inner arc, gaps, odd sizes.
#pragma once

#include <random>

#include "core/reslice/band.h"
#include "tests/support/test_sweep.h"

namespace sonoband::test {

struct RandomScene {
  TestSweep sweep;
  ReslicePlane plane;
  RenderSettings settings;
};

// One seed, one scene. About half have a mask, a third Doppler pictures.
RandomScene random_scene(unsigned seed);

// A sector with its arc near the top, as a curved probe's picture has: non-zero inside.
Pixels sector_mask(int width, int height);

}  // namespace sonoband::test
