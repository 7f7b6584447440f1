// A coarse picture soon, the full one after it: for slow machines while something moves.
#pragma once

#include <functional>

#include "core/reslice/prepared_sweep.h"

namespace sonoband {

// Every factor-th pixel: pixel (x, y) lies where pixel (factor x, factor y) of the full picture does.
ReslicePlane coarse_plane(const ReslicePlane& plane, int factor);
// Every factor-th layer from the middle on; all are layers of the full band.
Band coarse_band(const Band& band, int factor);

// What a caller allows who would rather have a coarse picture than none.
struct TimeBudget {
  int factor = 2;  // of the coarse picture; it costs 1 / factor^3. Below 2 there is none
  // By the caller's clock: true once the time is over, from then on. Asked on any of the threads, between
  // strips of the full picture. Empty: over at once.
  std::function<bool()> spent;
};

// Paints the coarse picture, then the full one. The coarse one is shown as soon as the budget is spent, the
// full one when it is done: where the budget suffices, alone. Painting goes on from where it was. `show` is
// called on the caller's thread, with the factor of the picture, and may use `parallel` and the sweep.
// Nothing is shown once `stop` is set, which any row of patches heeds. Nothing is coarser than asked unless
// this is called.
void render_progressively(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                          const TimeBudget& budget, Parallel& parallel, const StopFlag* stop,
                          const std::function<void(BandImage, int factor)>& show);

}  // namespace sonoband
