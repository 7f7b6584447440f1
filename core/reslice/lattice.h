// Bundles whose lines are equally spaced in every direction: planes. Their samples form a lattice on which
// all is affine: sample a of row b of layer l.
#pragma once

#include <optional>

#include "core/reslice/cull.h"

namespace sonoband {

struct Lattice {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // sample (0, 0, 0)
  Eigen::Vector3d per_sample = Eigen::Vector3d::Zero(), per_row = Eigen::Vector3d::Zero(),
                  per_layer = Eigen::Vector3d::Zero();  // mm
  int samples = 0, rows = 0, layers = 0;

  Eigen::Vector3d at(double a, double b, double l) const {
    return origin + a * per_sample + b * per_row + l * per_layer;
  }
};

// By the starts of the first line, of the last row's and of the last layer's.
Lattice lattice_through(const Eigen::Vector3d& origin, const Eigen::Vector3d& per_sample,
                        const Eigen::Vector3d& last_row, const Eigen::Vector3d& last_layer, int samples,
                        int rows, int layers);

// Empty where a line is absent or starts more than 1 nm off the lattice.
std::optional<Lattice> lattice_of(const LineBundle& bundle);

// The same lattice in its own coordinates (sample, row, layer): boxes lie along them, so that a frame's
// extremes over a box cost three products.
Lattice in_own_coordinates(const Lattice& lattice);
// The frames as functions of those coordinates.
FrameTable seen_from(const Lattice& lattice, const FrameTable& table);

// A block of a lattice: samples [a, a + width) of rows [b, b + height) of layers [l, l + depth).
struct LatticeBlock {
  int a = 0, b = 0, l = 0;
  int width = 0, height = 0, depth = 0;
};
// In the lattice's own coordinates.
SampleBox box_of(const LatticeBlock& block);

}  // namespace sonoband
