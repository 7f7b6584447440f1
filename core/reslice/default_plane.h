// A plane to begin with, when nobody has said which.
#pragma once

#include <optional>

#include "core/geometry/plane.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband {

// Across the frames of a sweep: right along the probe's travel (so that a B-scan is a vertical line, as in
// the paper's Figure 2), down along the pictures' x, through all frames at the fraction `depth` of their
// height (0 at the probe, 1 at the bottom). Just large enough to hold every frame's outline projected onto
// it; pixels as wide as the B-scans'. A probe that did not travel is seen along its mean normal instead.
// Empty without frames.
std::optional<ReslicePlane> default_plane(const SweepView& sweep, double depth = 0.5);

}  // namespace sonoband
