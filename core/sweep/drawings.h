// What the scanner draws over the pictures of a sweep and never moves (core/image/overlay.h).
#pragma once

#include <span>

#include "core/sweep/tracked_frame.h"

namespace sonoband {

// Whether a corner of the picture went far enough that speckle changed everywhere: 2 mm, several resolution
// cells in elevation. Of frames of one size, in pixels.
bool probe_moved(std::span<const TrackedFrame* const> frames, int width, int height);

// The sweep's mask without what the scanner draws over its Doppler pictures: the white box round the coloured
// region, text. Found from at most 32 frames, evenly spread: about 2 ms at 640 x 480. Of grey sweeps, which
// have no box, and of those in which too little moved to tell, it is the mask as it was. Empty where all
// counts.
Pixels mask_without_drawings(const SweepView& sweep);

}  // namespace sonoband
