// The work every speed is quoted for: 640x480 B-scans of 0.2 mm over 100 mm with a hand's smooth wobble of 3
// degrees and 0.5 mm and a fan of 8 degrees at the end; planes of 640x480 at 0.2 mm.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/plane.h"
#include "tests/support/test_sweep.h"

namespace sonoband::test {

struct SpeedSweepOptions {
  int frames = 200;
  int width = 640;
  int height = 480;
  double pixel_mm = 0.2;
  double length_mm = 100;
  bool crossing = false;  // each frame independently +-3 degrees and +-0.5 mm: neighbours cross
};

// World: x lateral (0 in the middle), y depth (0 at the probe), z along the sweep. Speckle with slow
// structure.
TestSweep speed_sweep(const SpeedSweepOptions& options = {});

struct NamedPlane {
  std::string name;
  ReslicePlane plane;
};

// C plane, longitudinal, parallel to the frames, oblique (35/40/25 degrees), tilted 60 degrees about lateral,
// C plane turned by 45 degrees in itself; all about the middle of the sweep.
std::vector<NamedPlane> speed_planes(int width = 640, int height = 480, double pixel_mm = 0.2);

// Uniformly turned planes about the middle of the sweep.
std::vector<ReslicePlane> random_planes(int count, unsigned seed, int width = 640, int height = 480,
                                        double pixel_mm = 0.2);

}  // namespace sonoband::test
