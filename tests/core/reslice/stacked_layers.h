// The definition of a rolling band: its layers, each painted by itself, compounded pixel by pixel.
#pragma once

#include "core/reslice/prepared_sweep.h"

namespace sonoband::test {

// Layer i from a plane's on, as a rolling band that began at the plane shows it when it comes straight there.
BandImage thin_layer(PreparedSweep& sweep, ReslicePlane plane, RenderSettings settings, int i);

// The band of settings.band about layer `middle` from `anchor` on.
BandImage stacked(PreparedSweep& sweep, const ReslicePlane& anchor, const RenderSettings& settings,
                  int middle);

}  // namespace sonoband::test
