// A plane to begin with, when nobody has said which.
#pragma once

#include <cstdint>
#include <optional>

#include "core/geometry/plane.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband {

// Both cross all frames, with right along the probe's travel, so that a B-scan is a vertical line as in the
// paper's Figure 2.
enum class PlaneView : std::uint8_t {
  level,    // down along the pictures' x, at one depth: the plane no scanner can show
  upright,  // down along the pictures' y, from the probe into the body
};

// Through every frame at the fraction `at` of its height (level; 0 at the probe) or of its width (upright),
// as nearly as the sweep's wobble allows. Just large enough to hold every frame's outline projected onto it;
// pixels as wide as the B-scans'. A probe that did not travel is seen along its mean normal instead. Empty
// without frames.
std::optional<ReslicePlane> default_plane(const SweepView& sweep, PlaneView view = PlaneView::level,
                                          double at = 0.5);

}  // namespace sonoband
