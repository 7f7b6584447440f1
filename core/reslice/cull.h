// Which frames matter to a block of samples. Everything is affine over a block, so a frame's extremes are
// known from its centre and half axes; no sample is searched.
#pragma once

#include <array>
#include <vector>

#include "core/reslice/frame_table.h"

namespace sonoband {

// A parallelepiped that holds the samples: centre + sum of t_k half[k], |t_k| <= 1. Axes: along the lines,
// from row to row, from layer to layer, and what these leave of an unrolled surface, per World axis.
struct SampleBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 6> half;

  double extent(const Eigen::Vector3d& gradient) const {
    double sum = 0;
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

// Those of `frames` (indices into the table, ascending) that can give a sample of the box its value,
// ascending. Left out are frames whose picture holds no foot of the box or that are out of reach everywhere,
// and frames behind one that serves the whole box: on the same side of every sample, farther from each, and
// so never nearest, neither of all frames nor of a side.
std::vector<int> cull(const FrameTable& table, const std::vector<int>& frames, const SampleBox& box,
                      Interpolation interpolation);

}  // namespace sonoband
