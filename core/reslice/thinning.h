// Frames of a whole sweep that may be left out when they lie denser than the output can show. `thinned` in
// band.h is the rule for linear interpolation; what a part of the picture sees of the frames lets chains
// (chain.h) leave out more.
#pragma once

#include "core/reslice/frame_table.h"

namespace sonoband {

// What thinning takes for a pixel, in pixels: half of it is half a pixel to 1/256 of one, the resolution that
// the weights of linear's taps have along a pixel row. So a sweep of 1000 frames over 100 mm, 0.1001 mm
// apart, is thinned like one of 1001. A blend's taps are then at most 0.504 pixels away in their mean by
// weight: on the steepest ramp, from black to white within a pixel, one level more than 0.5.
constexpr double thinning_pixel = 1 + 1.0 / 128;

// The rule for nearest: those of sweep.frames that stay when, of two that stay in turn, each is at most a
// pixel of `pixel_mm` (thinning_pixel) from the frame before, or after, the other at every corner, and those
// between them follow one another without crossing. A sample nearest to a frame that stays is then at most
// half a pixel from a point where that frame is the nearest of all: beyond half the gap to the next, which is
// the definition's own, no more is left. First and last of a sweep stay, and frames where it does not move
// steadily.
std::vector<const TrackedFrame*> thinned_for_nearest(const SweepView& sweep, double pixel_mm);

// The table of the frames that stay by this rule, or for linear by that of `thinned`.
FrameTable make_thinned_table(const SweepView& sweep, const GapLimit& gap, double pixel_mm,
                              Interpolation interpolation);

}  // namespace sonoband
