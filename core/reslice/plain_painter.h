// The plain kernel: every candidate's distance at every sample, in double precision. For bundles no faster
// one holds: pixels many times larger than the B-scans', or pictures of more than 8000 pixels.
#pragma once

#include <atomic>

#include "core/reslice/frame_table.h"

namespace sonoband {

void paint_plainly(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                   Parallel& parallel, const std::atomic<bool>* stop, BandImage& image);

}  // namespace sonoband
