// Samples of a chain whose nearest frame's picture ends before them: the next nearest frame that has them.
#pragma once

#include <array>
#include <vector>

#include "core/reslice/chain_cells.h"

namespace sonoband {

class ChainEnds {
 public:
  // A patch's lanes by layer, to which take_chain_ends adds those that their nearest frame does not have.
  LaneMask* without() { return without_.data(); }
  void clear() { without_.fill(0); }

  // Compounds what other frames within reach give to those lanes, each the nearest's, of equally near ones
  // the latest's. `cells` are of a chain whose pictures end, laid out for patches of `grid`.
  void hand_over(const ChainCells& cells, const LaneGrid& grid, const PatchSite& site, Rule rule,
                 PatchSums& sums);

 private:
  // What a member takes of layers first .. last - 1.
  struct Share {
    int member = 0;
    int first = 0, last = 0;
    std::array<LaneMask, patch_layers> lanes;  // from `first` on
    std::array<FixedPx, patch_layers> x, y;    // of lane 0
  };
  void claim(const ChainCells& cells, const LaneGrid& grid, const PatchSite& site, int member);

  std::array<LaneMask, patch_layers> without_{}, given_{};
  // Of lanes in given_: the distance of the nearest frame so far, and its share.
  std::array<std::array<float, patch_lanes>, patch_layers> nearest_mm_;
  std::array<std::array<std::uint16_t, patch_lanes>, patch_layers> share_of_;
  std::vector<Share> shares_;  // the first `share_count_` count
  std::size_t share_count_ = 0;
};

}  // namespace sonoband
