// The order in which frames were captured, which decides ties and neighbours; the order of a span decides
// nothing.
#pragma once

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/sweep/tracked_frame.h"

namespace sonoband {

// True where `a` is earlier, so that of equal |z| `b` wins.
inline bool captured_before(const TrackedFrame& a, const TrackedFrame& b) {
  return std::tie(a.captured, a.sweep_id, a.sequence) < std::tie(b.captured, b.sweep_id, b.sequence);
}

// Indices into sweep.frames, earliest first.
inline std::vector<int> capture_order(const SweepView& sweep) {
  std::vector<int> order(sweep.frames.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return captured_before(*sweep.frames[a], *sweep.frames[b]); });
  return order;
}

}  // namespace sonoband
