// The paper's fast, approximate normal flow (Figure 10). Not for use outside.
#pragma once

#include "core/manifold/offset_curve.h"

namespace sonoband::flow {

// The fronts of layers 1..layers of one side. Every vertex runs along its normal at d / sin(theta) per layer;
// where neighbouring normals meet, the edge between them has vanished and one vertex goes on between the
// edges left and right of it. As in the paper there are no arcs (a spreading corner stays a corner) and parts
// of the curve that are not neighbours run through each other.
//
// Where the paper is silent: an end vertex whose edge has vanished goes on along the normal of the next edge;
// a closed front of two edges has vanished; a vertex runs at most `fastest` times as far as its front, which
// cuts off the corner of a curve that turns back on itself. O(n log n + layers n).
std::vector<Front> route_map_fronts(const Side& side, int layers);

}  // namespace sonoband::flow
