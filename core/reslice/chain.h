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

}  // namespace sonoband
