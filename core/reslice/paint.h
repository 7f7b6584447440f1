// From a bundle or a plane to a picture: the choice of kernel and the spreading over threads.
#pragma once

#include <atomic>

#include "core/reslice/frame_table.h"
#include "core/reslice/lattice.h"

namespace sonoband {

// What lattice_of(plane_lines(plane, band)) gives, bit for bit, without the lines.
Lattice plane_lattice(const ReslicePlane& plane, const Band& band);

BandImage paint(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop);
BandImage paint(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop);

}  // namespace sonoband
