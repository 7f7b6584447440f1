// The scanner's beams and how its screen is filled from them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hal/sim/scanner.h"

namespace sonoband::sim {

// A beam in the picture: sample s is at start + s * step, in pixels.
struct ScanLine {
  Eigen::Vector2d start;
  Eigen::Vector2d step;
};

// Echoes are gathered in rows of one sample of all beams; then each pixel of the body takes the bilinear mean
// of the four echoes round it (scan conversion).
struct ScanLines {
  int beams = 0;
  int samples = 0;
  double sample_mm = 0;
  std::vector<ScanLine> lines;

  struct Tap {
    std::uint32_t echo;  // index of the sample above and the beam to the left
    std::uint8_t beam_256;
    std::uint8_t sample_256;
  };
  struct Run {
    int y;
    int x_begin;
    int x_end;
    std::size_t first_tap;
  };
  std::vector<Run> runs;  // per row that shows the body, left to right
  std::vector<Tap> taps;
};

ScanLines make_scan_lines(const ScannerSettings& s);

}  // namespace sonoband::sim
