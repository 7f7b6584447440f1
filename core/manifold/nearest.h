// From the rulings of c(s) to a front, and from a front to lines. Not for use outside.
#pragma once

#include "core/manifold/chord_tree.h"
#include "core/manifold/offset_curve.h"

namespace sonoband::flow {

// What may stand between a ruling and the front. Empty: nothing does, and the front counts as unbroken (the
// paper's route map, which never looks at parts of the curve that are not neighbours).
using Walls = const ChordTree*;

// FlowLayer::feet of one side at height h, in steps; see there for the rule.
std::vector<std::optional<PlanePoint>> find_feet(const Side& side, const Front& front, double h,
                                                 const std::vector<Standing>& rulings, Walls walls);

// FlowLayer::front of one side at height h, in steps. `unbroken`: pieces that follow each other are one line
// whether they touch or not.
std::vector<PlaneLine> draw_front(const Side& side, const Front& front, double h, bool unbroken);

}  // namespace sonoband::flow
