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

// Leaves out members that lie denser than the output's pixels of `pixel_mm`, by a rule that keeps the
// definition's values within half an output pixel in position, at every sample of the box; a pixel counts as
// thinning_pixel (thinning.h) says. Members between two that stay go where,
//  - nearest, of a table with all frames of the sweep: from either of the two to the one before the other is
//  at most a pixel. So a sample takes
//    the pixel that the definition, with all frames, takes at a point at most half a pixel away: beyond half
//    the gap to the next frame, which is the definition's own, no more than half a pixel is left to go;
//  - else: the two are at most a pixel apart. So a sample is at most half a pixel from the nearest of them,
//    and linear a sample blends values that the definition takes at two
//    points, on the planes of the two, whose distance from the sample is at most half a pixel in their mean
//    by weight: 2 w (1 - w) gap.
// The first and the last member stay. Gaps count as the widest in the box and half a pixel about it.
void thin_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                double pixel_mm, Interpolation interpolation, Chain& chain);

}  // namespace sonoband
