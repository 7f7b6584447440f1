// Going through the cells of a chain that a patch meets.
#pragma once

#include <algorithm>
#include <array>

#include "core/reslice/patch.h"

namespace sonoband {

// Layers of a patch, low <= l < high.
struct LayerRange {
  int low = 0, high = 0;
};

// Of |x| <= 300; std::floor and std::ceil are calls without SSE4.1.
[[gnu::always_inline]] inline int floor_of(float x) {
  const int i = static_cast<int>(x);
  return i - (static_cast<float>(i) > x ? 1 : 0);
}
[[gnu::always_inline]] inline int ceil_of(float x) {
  const int i = static_cast<int>(x);
  return i + (static_cast<float>(i) < x ? 1 : 0);
}

// What one boundary leaves of a patch's layers, over all lanes. Exact: rounding keeps the order of sums.
struct BoundaryReach {
  float least, greatest;  // of the layer where it changes, over the lanes
  [[gnu::always_inline]] BoundaryReach(const ChainBoundary& boundary, const PatchSite& site) {
    const float at = boundary.at(site);
    least = std::clamp(at + boundary.least, -2.0F, 300.0F);
    greatest = std::clamp(at + boundary.greatest, -2.0F, 300.0F);
  }
  [[gnu::always_inline]] bool everywhere(const ChainBoundary& boundary, const PatchSite& site) const {
    if (boundary.always || boundary.never) return boundary.always;
    return boundary.rising ? greatest <= static_cast<float>(site.first)
                           : least >= static_cast<float>(site.depth - 1);
  }
  [[gnu::always_inline]] bool nowhere(const ChainBoundary& boundary, const PatchSite& site) const {
    if (boundary.always || boundary.never) return boundary.never;
    return boundary.rising ? least > static_cast<float>(site.depth - 1)
                           : greatest < static_cast<float>(site.first);
  }
  // All lanes change between the same two layers: range says it all.
  [[gnu::always_inline]] bool at_once(const ChainBoundary& boundary) const {
    return boundary.rising ? ceil_of(least) == ceil_of(greatest) : floor_of(least) == floor_of(greatest);
  }
};

// Narrows `range` to layers where some lane has the boundary hold, or not hold.
[[gnu::always_inline]] inline void keep_holding(const ChainBoundary& boundary, const BoundaryReach& reach,
                                                LayerRange& range) {
  if (boundary.rising) {
    range.low = std::max(range.low, ceil_of(reach.least));
  } else {
    range.high = std::min(range.high, floor_of(reach.greatest) + 1);
  }
}
[[gnu::always_inline]] inline void keep_not_holding(const ChainBoundary& boundary, const BoundaryReach& reach,
                                                    LayerRange& range) {
  if (boundary.rising) {
    range.high = std::min(range.high, ceil_of(reach.greatest));
  } else {
    range.low = std::max(range.low, floor_of(reach.least) + 1);
  }
}

// Calls visit(cell, from, to, range) for every cell with layers in the patch; `from` or `to` is null where
// the cell's boundary on that side leaves all of the range.
// Returns the cell it began with.
template <class Visit>
[[gnu::always_inline]] inline int walk_chain(const ChainBoundary* boundaries, int count,
                                             const PatchSite& site, Visit visit) {
  // Where a boundary holds everywhere, so do those before it.
  int start = std::min(site.start, count - 1);
  while (start > 0 && !BoundaryReach(boundaries[start], site).everywhere(boundaries[start], site)) --start;
  const ChainBoundary* from = boundaries + start;
  BoundaryReach from_reach(*from, site);
  for (int cell = start; cell < count; ++cell) {
    const ChainBoundary* to = boundaries + cell + 1;
    const BoundaryReach to_reach(*to, site);
    if (to_reach.everywhere(*to, site)) {
      from = to;
      from_reach = to_reach;
      start = cell + 1;
      continue;
    }
    const bool begun = from_reach.everywhere(*from, site);
    if (!begun && from_reach.nowhere(*from, site)) break;
    const bool ends = !to_reach.nowhere(*to, site);
    LayerRange range{site.first, site.depth};
    if (!begun) keep_holding(*from, from_reach, range);
    if (ends) keep_not_holding(*to, to_reach, range);
    if (range.low < range.high)
      visit(cell, begun || from_reach.at_once(*from) ? nullptr : from,
            ends && !to_reach.at_once(*to) ? to : nullptr, range);
    if (!ends) break;
    from = to;
    from_reach = to_reach;
  }
  return start;
}

}  // namespace sonoband
