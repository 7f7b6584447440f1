// Figure 9b of the paper: every ruling's normal. Not for use outside.
#pragma once

#include "core/manifold/offset_curve.h"

namespace sonoband::flow {

// In steps: each ruling's point at height h on its normal (on a vertex: on the bisector). Joined up, they are
// the front, swallowtails and all.
PlaneLine naive_front(const Side& side, double h, const std::vector<Standing>& rulings);

}  // namespace sonoband::flow
