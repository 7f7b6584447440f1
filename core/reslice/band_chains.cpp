// Patches of a region whose frames are a chain, laid out as cells.
#include <algorithm>
#include <array>

#include "core/reslice/band_painter.h"
#include "core/reslice/patch_kernels.h"

namespace sonoband {

int BandPainter::paint_cells(const ChainCells& cells, const PatchSite& site) {
  const int count = static_cast<int>(cells.boundaries.size()) - 1;
  if (!cells.reaches.empty()) {
    ends_.clear();
    const int start = patch_kernels().take_chain_ends(cells.frames.data(), cells.boundaries.data(), count,
                                                      site, rule_, totals_.piece(), ends_.without());
    ends_.hand_over(cells, tile_.grid, site, rule_, totals_.piece());
    return start;
  }
  if (!linear_) {
    return patch_kernels().take_chain(cells.frames.data(), cells.boundaries.data(), count, site, rule_,
                                      totals_.piece());
  }
  if (cells.unblended) {
    return patch_kernels().take_chain_linear(cells.frames.data(), cells.boundaries.data(), count, site, rule_,
                                             totals_.piece());
  }
  if (cells.grey_taps) {
    return patch_kernels().blend_chain(cells.frames.data(), cells.shares.data(), cells.boundaries.data(),
                                       count, site, rule_, totals_.piece());
  }
  std::array<LaneMask, patch_layers> masks;
  return walk_chain(
      cells.boundaries.data(), count, site,
      [&](int cell, const ChainBoundary* from, const ChainBoundary* to, const LayerRange& range) {
        std::fill_n(masks.begin(), range.high - range.low, site.lanes);
        LayerThresholds thresholds;
        if (from != nullptr) {
          patch_kernels().thresholds(*from, site, thresholds);
          patch_kernels().hold(thresholds, true, range.low, range.high, masks.data());
        }
        if (to != nullptr) {
          patch_kernels().thresholds(*to, site, thresholds);
          patch_kernels().hold(thresholds, false, range.low, range.high, masks.data());
        }
        blend_cell(cells, cell, site, range, masks.data());
      });
}

// As paint_cells; layers kept apart one at a time, the first of the piece being `first_layer`.
int BandPainter::paint_layers(const ChainCells& cells, PatchSite site, int first_layer) {
  if (!apart()) return paint_cells(cells, site);
  const int layers = site.depth, a = tile_.block.a + site.da, b = tile_.block.b + site.db;
  if (!linear_) {
    const std::uint8_t missing = rule_ == Rule::minimum ? 255 : 0;
    for (int l = 0; l < layers; ++l) apart_.values[l].fill(missing);
    apart_.has_data.fill(0);
    const int count = static_cast<int>(cells.boundaries.size()) - 1;
    const int start =
        patch_kernels().take_chain_apart(cells.frames.data(), cells.boundaries.data(), count, site, apart_);
    PatchTotals::store(apart_, layers, *layers_, first_layer, a, b, tile_.shape);
    return start;
  }
  for (int l = 0; l < layers; ++l) {
    site.first = l;
    site.depth = l + 1;
    totals_.clear();
    site.start = paint_cells(cells, site);
    store_layer(first_layer + l, a, b);
  }
  return site.start;
}

// Calls visit(site) for every patch of a region, which is the whole tile where patches are sheared; those
// that the shear puts across its edges are cut there.
template <class Visit>
void BandPainter::for_patches(const LatticeBlock& region, Visit visit) {
  const LaneShape shape = tile_.shape;
  const LaneGrid& grid = tile_.grid;
  const int a = region.a - tile_.block.a, b = region.b - tile_.block.b;
  const auto first = [](int greatest, int side) { return -(greatest / side * side); };
  for (int db = first(grid.greatest_b, shape.down()); db + grid.least_b < region.height; db += shape.down()) {
    if (stopped()) return;
    for (int da = first(grid.greatest_a, shape.across); da + grid.least_a < region.width;
         da += shape.across) {
      const LaneMask lanes = existing_lanes(grid, da, db, region.width, region.height);
      if (lanes != 0) visit(PatchSite{a + da, b + db, region.depth, lanes});
    }
  }
}

void BandPainter::store(const PatchSite& site) {
  const int a = tile_.block.a + site.da, b = tile_.block.b + site.db;
  // Rectangles are stored faster; lanes that do not exist may be another tile's pixels.
  if (!tile_.shape.sheared() && site.lanes == ~LaneMask{0}) {
    totals_.store(*image_, a, b, tile_.shape);
  } else {
    totals_.store(*image_, a, b, tile_.grid, site.lanes);
  }
}

// Of cells_ in the patches of group_: all that their frames' pictures are sure to hold. The rest goes to
// edges_.
void BandPainter::take_group() {
  totals_.clear();
  std::fill_n(group_.sums.begin(), group_.count, totals_.piece());
  for (int patch = 0; patch < group_.count; ++patch) edges_[patch].clear();
  const bool ends = !cells_.reaches.empty();
  const int count = static_cast<int>(cells_.boundaries.size()) - 1;
  std::array<std::uint8_t, group_patches> at_edge;
  const auto rows = [&](std::size_t cell) {
    const bool asked = cell < cells_.members.size() && !tile_.parts_to_turn();
    return asked ? tile_.rows_of(cells_.members[cell]) : RowsAhead{};
  };
  for (std::size_t cell = 0; cell < cells_ahead; ++cell) rows(cell).ask_all();
  for (int cell = 0; cell < count; ++cell) {
    group_.ahead = rows(cell + cells_ahead);
    const int found = patch_kernels().take_cell(cells_.frames[cell], cells_.boundaries.data() + cell, ends,
                                                rule_, group_, at_edge.data());
    group_.ahead.ask_all();
    for (int i = 0; i < found; ++i) edges_[at_edge[i]].push_back(cell);
  }
}

// Paints the patches of group_ and empties it.
void BandPainter::paint_group() {
  if (group_.count == 0) return;
  take_group();
  for (int patch = 0; patch < group_.count; ++patch) {
    const PatchSite& site = group_.sites[patch];
    totals_.piece() = group_.sums[patch];
    if (!edges_[patch].empty()) {
      ends_.clear();
      for (const int cell : edges_[patch])
        patch_kernels().take_chain_ends(cells_.frames.data() + cell, cells_.boundaries.data() + cell, 1, site,
                                        rule_, totals_.piece(), ends_.without());
      ends_.hand_over(cells_, tile_.grid, site, rule_, totals_.piece());
    }
    store(site);
  }
  group_.count = 0;
}

void BandPainter::paint_chain(const Lattice& lattice, const LatticeBlock& region, const SampleBox& box,
                              const std::vector<Candidate>& candidates, const Chain& chain) {
  lay_out(lattice, tile_, chain, candidates, box, 0, interpolation(), cells_);
  if (takes_cells()) {
    group_.count = 0;
    for_patches(region, [&](const PatchSite& site) {
      group_.add(site);
      if (group_.count == group_patches) paint_group();
    });
    if (!stopped()) paint_group();
    return;
  }
  int start = 0;
  for_patches(region, [&](PatchSite site) {
    site.start = start;
    if (!apart()) totals_.clear();
    start = paint_layers(cells_, site, 0);
    if (!apart()) store(site);
  });
}

}  // namespace sonoband
