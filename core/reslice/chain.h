// Frames that follow one another through a block of samples without crossing: there the nearest frame changes
// only at the bisectors of neighbours, z_i + z_(i+1) = 0, and no other pair need be compared.
#pragma once

#include <span>
#include <vector>

#include "core/reslice/cull.h"

namespace sonoband {

struct Chain {
  std::vector<int> members;  // indices into the candidates, by falling z
  bool first_ends = false;   // samples may lie beyond the first frame: its reach must be checked
  bool last_ends = false;
  bool whole = true;  // every member's picture and mask hold every foot
  // Linear: samples take their nearest member's bilinear value and no blend (thin_chain).
  bool unblended = false;
};

// True where the bisectors alone give the definition's nearest frame at every sample of the box:
//  - every candidate's picture and mask hold every foot, so any is admissible but for its reach;
//  - z falls from each to the next at every sample (an affine difference of one sign), so that of the frames
//    on either side of a sample the two next to it are nearest;
//  - no gap is wider than twice the smaller reach of its two frames, so that the nearer of the two is in
//  reach;
//  - beyond either end the end frame is nearest, and where it is out of reach every other is too.
bool make_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                Chain& chain);

// True where all but the first of these holds: pictures may end in the box. Of all frames, whatever their
// pictures hold, the bisectors then give the nearest, and where its picture holds the foot it is the
// definition's. Elsewhere another one may be (chain_ends.h).
bool make_ending_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                       Chain& chain);

// A pixel of the picture as thinning counts positions: half a pixel along each of the picture's axes.
struct OutputPixel {
  double mm = 0;  // its width
  // Unit vectors in World: right, down and the normal. Zero: half a pixel whichever way.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();

  // Two points on a line along `normal` (of unit length, in World) that are so far apart, in mm, are a pixel
  // apart: it is longer where the line runs between the axes. Of thinning_pixel (thinning.h).
  double along(const Eigen::Vector3d& normal) const;
};

// Leaves out members that lie denser than the output's pixels, by a rule that keeps the definition's values
// within half an output pixel in position (right, down and across the layers), at every sample of the box.
// Members between two that stay go where,
//  - nearest, of a table with all frames of the sweep: from either of the two to the one before the other is
//    at most a pixel. So a sample takes the pixel that the definition, with all frames, takes at a point at
//    most half a pixel away: beyond half the gap to the next frame, which is the definition's own, no more
//    than half a pixel is left to go;
//  - else: the two are at most a pixel apart. So a sample is at most half a pixel from the nearest of them.
// Linear: where all that stay are at most a pixel apart, a sample takes the bilinear value of the nearest
// alone, which is the definition's on that frame's plane, at a point at most half a pixel away (`unblended`).
// Else the chain is blended: exactly where no frame went between, and from two points at most half a pixel
// away in their mean by weight, 2 w (1 - w) gap, where some did; and so are Doppler and taps that a mask
// takes away. The first and the last member stay. Gaps count as the widest in the box and half a pixel about
// it.
void thin_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                const OutputPixel& pixel, Interpolation interpolation, Chain& chain);

}  // namespace sonoband
