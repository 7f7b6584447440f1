// Which frames matter to a block of samples. Everything is affine over a block, so a frame's extremes are
// known from its centre and half axes; no sample is searched.
#pragma once

#include <array>
#include <vector>

#include "core/reslice/frame_table.h"

namespace sonoband {

// A parallelepiped that holds the samples: centre + sum of t_k times its axes, |t_k| <= 1. Axes: along the
// coordinates, which is all a lattice's box in its own coordinates has; and of an unrolled surface, in World,
// along the lines, from row to row and from layer to layer.
struct SampleBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::Zero();  // half axes along the coordinates
  bool slanted = false;                             // has those of `half` as well
  std::array<Eigen::Vector3d, 3> half;

  double extent(const Eigen::Vector3d& gradient) const {
    double sum = gradient.cwiseAbs().dot(along);
    if (!slanted) return sum;
    for (const Eigen::Vector3d& h : half) sum += std::abs(gradient.dot(h));
    return sum;
  }
};

struct BundleBlock {
  int row_begin = 0, row_end = 0;
  int sample_begin = 0, sample_end = 0;
};

// The box of all present lines of a block; `empty` when there is none.
struct BlockBox {
  SampleBox box;
  bool empty = true;
};
BlockBox box_of(const LineBundle& bundle, const BundleBlock& block);

// Lowest and highest value over a box.
struct Span {
  double lowest = 0, highest = 0;
};
inline Span span_of(const AffineScalar& f, const SampleBox& box) {
  const double centre = f.at(box.centre), extent = box.extent(f.gradient);
  return {centre - extent, centre + extent};
}

struct Candidate {
  int frame = 0;              // index into the table
  bool full = false;          // picture and mask hold every foot of the box
  bool borders_mask = false;  // not every pixel about the feet is in the mask
  Span z;                     // mm, by the common orientation
  double z_centre = 0;
};

// The frame's z by the common orientation.
inline AffineScalar oriented_z(const FrameEntry& frame) {
  if (!frame.flipped) return frame.z_mm;
  return {-frame.z_mm.gradient, -frame.z_mm.offset};
}

// Those of `frames` (indices into the table, ascending) that can give a sample of the box its value,
// ascending. Left out are frames whose picture holds no foot of the box or that are out of reach everywhere,
// and frames behind one that serves the whole box: on the same side of every sample, farther from each, and
// so never nearest, neither of all frames nor of a side.
void cull(const FrameTable& table, const std::vector<int>& frames, const SampleBox& box,
          Interpolation interpolation, std::vector<Candidate>& kept);

}  // namespace sonoband
