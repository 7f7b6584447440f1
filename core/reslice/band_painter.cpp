#include "core/reslice/band_painter.h"

#include <algorithm>
#include <utility>

namespace sonoband {
namespace {

// Above so many candidates a patch of many layers is cheaper in halves.
constexpr std::size_t many_candidates = 10;

}  // namespace

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

// No data in a block. Layers apart may hold older ones; a picture is blank from the start.
void BandPainter::blank(const LatticeBlock& block) {
  if (!apart()) return;
  const std::uint8_t missing = rule_ == Rule::minimum ? 255 : 0;
  for (int l = block.l; l < block.l + block.depth; ++l) {
    for (int y = block.b; y < block.b + block.height; ++y) {
      std::fill_n(layers_->values_row(l, y) + block.a, block.width, missing);
    }
  }
  const auto others = static_cast<std::uint16_t>(~LayerBlock::bits(block.l, block.depth));
  for (int y = block.b; y < block.b + block.height; ++y) {
    std::uint16_t* has = layers_->has_data.view().row(y) + block.a;
    for (int x = 0; x < block.width; ++x) has[x] &= others;
  }
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

// What each candidate gives to some layers of place_.
void BandPainter::paint_shares(const std::vector<Candidate>& candidates,
                               const std::vector<const PatchFrame*>& frames, const LayerRange& range) {
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Winners::Share& s = winners_.share(c);
    const int first = std::max(s.first, range.low), last = std::min(s.last, range.high);
    if (first >= last) continue;
    if (linear_) {
      for (int other = -1; other < static_cast<int>(c); ++other)
        blend_shares(candidates, frames, c, other, range);
    } else {
      patch_kernels().take(*frames[c], s.x.data() + first, s.y.data() + first, s.wins.data() + first,
                           last - first, rule_, totals_.piece());
    }
  }
}

// Any geometry, at place_.
void BandPainter::paint_place(const std::vector<Candidate>& candidates,
                              const std::vector<const PatchFrame*>& frames) {
  winners_.find(table(), candidates, frames, place_, tile_.grid, interpolation());
  paint_shares(candidates, frames, {0, place_.layers});
}

void BandPainter::thin(const std::vector<Candidate>& candidates, const SampleBox& box, Chain& chain) {
  if (thinning_.pixel.mm == 0) return;
  const std::size_t members = chain.members.size();
  thin_chain(table(), candidates, box, thinning_.pixel, interpolation(), chain);
  // Tiles of the table for the rest are counted as they are opened.
  if (thinning_.rest == nullptr) left_out_.add(members, chain.members.size());
}

bool BandPainter::find_chain(const std::vector<Candidate>& candidates, const SampleBox& box,
                             Chain& chain) const {
  return may_end() ? make_ending_chain(table(), candidates, box, chain)
                   : make_chain(table(), candidates, box, chain);
}

// A patch of a tile whose frames are no chain throughout.
void BandPainter::paint_block(const Lattice& lattice, const LatticeBlock& block,
                              const std::vector<int>& frames) {
  std::vector<Candidate> candidates;
  const SampleBox box = box_of(block);
  cull(table(), frames, box, interpolation(), candidates);
  if (candidates.empty()) {
    blank(block);
    return;
  }
  const LaneMask lanes = existing_lanes(tile_.shape, block.width, block.height);
  Chain chain;
  if (find_chain(candidates, box, chain)) {
    thin(candidates, box, chain);
    lay_out(lattice, tile_, chain, candidates, box, block.l, interpolation(), cells_);
    paint_layers(cells_, {block.a - tile_.block.a, block.b - tile_.block.b, block.depth, lanes}, block.l);
    return;
  }
  if (candidates.size() > many_candidates && block.depth > 8) {
    std::vector<int> near;
    for (const Candidate& c : candidates) near.push_back(c.frame);
    LatticeBlock half = block;
    half.depth = block.depth / 2;
    paint_block(lattice, half, near);
    half.l += half.depth;
    half.depth = block.depth - half.depth;
    paint_block(lattice, half, near);
    return;
  }
  place_.layers = block.depth;
  place_.shape = tile_.shape;
  place_.sample_step = lattice.per_sample;
  place_.row_step = lattice.per_row;
  for (int l = 0; l < block.depth; ++l) {
    const Eigen::Vector3d p = lattice.at(block.a, block.b, block.l + l);
    place_.x[l] = p.x();
    place_.y[l] = p.y();
    place_.z[l] = p.z();
    place_.lanes[l] = lanes;
  }
  std::vector<const PatchFrame*> patch_frames;
  for (const Candidate& c : candidates) patch_frames.push_back(&tile_.frames[tile_.index_of(c.frame)].patch);
  if (!apart()) {
    paint_place(candidates, patch_frames);
    return;
  }
  winners_.find(table(), candidates, patch_frames, place_, tile_.grid, interpolation());
  for (int l = 0; l < block.depth; ++l) {
    totals_.clear();
    paint_shares(candidates, patch_frames, {l, l + 1});
    store_layer(block.l + l, block.a, block.b);
  }
}

// Calls paint(a, b, width, height) for every patch of a region.
template <class Paint>
void BandPainter::paint_patches(const LatticeBlock& region, Paint paint) {
  const LaneShape shape = tile_.shape;
  for (int b = region.b; b < region.b + region.height; b += shape.down()) {
    if (stopped()) return;
    for (int a = region.a; a < region.a + region.width; a += shape.across) {
      const int width = std::min(shape.across, region.a + region.width - a);
      const int height = std::min(shape.down(), region.b + region.height - b);
      if (!apart()) totals_.clear();
      paint(a, b, width, height);
      if (!apart()) totals_.store(*image_, a, b, shape);
    }
  }
}

// Calls paint(da, db, lanes) for every patch of the whole tile, from its corner; those that the shear puts
// across the tile's edges are cut there.
template <class Paint>
void BandPainter::paint_sheared(Paint paint) {
  const LaneShape shape = tile_.shape;
  const LatticeBlock& block = tile_.block;
  const LaneGrid& grid = tile_.grid;
  const auto first = [](int greatest, int side) { return -(greatest / side * side); };
  for (int db = first(grid.greatest_b, shape.down()); db + grid.least_b < block.height; db += shape.down()) {
    if (stopped()) return;
    for (int da = first(grid.greatest_a, shape.across); da + grid.least_a < block.width; da += shape.across) {
      const LaneMask lanes = existing_lanes(grid, da, db, block.width, block.height);
      if (lanes == 0) continue;
      totals_.clear();
      paint(da, db, lanes);
      totals_.store(*image_, block.a + da, block.b + db, grid, lanes);
    }
  }
}

void BandPainter::paint_chain(const Lattice& lattice, const LatticeBlock& region, const SampleBox& box,
                              const std::vector<Candidate>& candidates, const Chain& chain) {
  lay_out(lattice, tile_, chain, candidates, box, 0, interpolation(), cells_);
  int start = 0;
  if (tile_.shape.sheared()) {
    paint_sheared([&](int da, int db, LaneMask lanes) {
      start = paint_layers(cells_, {da, db, region.depth, lanes, start}, 0);
    });
    return;
  }
  paint_patches(region, [&](int a, int b, int width, int height) {
    const LaneMask lanes = existing_lanes(tile_.shape, width, height);
    start = paint_layers(cells_, {a - tile_.block.a, b - tile_.block.b, region.depth, lanes, start}, 0);
  });
}

void BandPainter::paint_tile(const Lattice& lattice) {
  if (tile_.parts_to_turn()) {
    tile_.turned_parts.turn();
    turned_parts_ = true;
  }
  if (tile_.is_chain && tile_.block.depth <= patch_layers) {
    paint_chain(lattice, tile_.block, tile_.box, tile_.candidates, tile_.chain);
    return;
  }
  std::vector<int> frames;
  for (const Candidate& c : tile_.candidates) frames.push_back(c.frame);
  paint_parts(lattice, tile_.block, frames);
}

// Paints patch after patch where the frames are a chain.
void BandPainter::paint_region(const Lattice& lattice, const LatticeBlock& region,
                               const std::vector<int>& frames) {
  if (stopped()) return;
  std::vector<Candidate> candidates;
  const SampleBox box = box_of(region);
  cull(table(), frames, box, interpolation(), candidates);
  if (candidates.empty()) {
    blank(region);
    return;
  }
  Chain chain;
  if (region.depth <= patch_layers && find_chain(candidates, box, chain)) {
    thin(candidates, box, chain);
    paint_chain(lattice, region, box, candidates, chain);
    return;
  }
  std::vector<int> near;
  for (const Candidate& c : candidates) near.push_back(c.frame);
  paint_parts(lattice, region, near);
}

// Halves a region whose frames are no chain, or paints its only patch.
void BandPainter::paint_parts(const Lattice& lattice, const LatticeBlock& region,
                              const std::vector<int>& frames) {
  const LaneShape shape = tile_.shape;
  const int across = (region.width + shape.across - 1) / shape.across;
  const int down = (region.height + shape.down() - 1) / shape.down();
  if (region.depth > patch_layers || across * down == 1) {
    paint_patches(region, [&](int a, int b, int width, int height) {
      for (int l = 0; l < region.depth; l += patch_layers) {
        if (l > 0 && !apart()) totals_.next_piece();
        paint_block(lattice, {a, b, l, width, height, std::min(patch_layers, region.depth - l)}, frames);
      }
    });
    return;
  }
  LatticeBlock first = region, second = region;
  // The longer side, in pixels, unless it is one patch.
  if (down == 1 || (across > 1 && region.width >= region.height)) {
    first.width = across / 2 * shape.across;
    second.a += first.width;
    second.width -= first.width;
  } else {
    first.height = down / 2 * shape.down();
    second.b += first.height;
    second.height -= first.height;
  }
  paint_region(lattice, first, frames);
  paint_region(lattice, second, frames);
}

std::vector<int> BandPainter::frames_near(const FrameTable& of, const SampleBox& box) const {
  std::vector<Candidate> candidates;
  cull(of, all_frames(of), box, interpolation(), candidates);
  std::vector<int> kept;
  for (const Candidate& c : candidates) kept.push_back(c.frame);
  return kept;
}

// False where no frame reaches the tile.
bool BandPainter::open_tile(Tile& tile, const Lattice& lattice, const Reach& reach, int a, int b,
                            const TileSize& size) {
  if (!tile.find(table_, lattice, reach.frames, interpolation(), may_end(), a, b, size)) return false;
  if (tile.is_chain && thinning_.pixel.mm > 0) {
    tile.thin(interpolation(), thinning_.pixel, left_out_);
  } else if (!tile.is_chain && thinning_.rest != nullptr) {
    const std::size_t all = tile.candidates.size();
    if (!tile.find(*thinning_.rest, lattice, reach.rest, interpolation(), may_end(), a, b, size))
      return false;
    left_out_.add(all, tile.candidates.size());
  }
  // Layers kept apart are stored by rectangles, and so are patches of bands that come in pieces; for the few
  // layers of a block turning a frame costs more than it saves.
  tile.open(lattice, interpolation(), !apart() && lattice.layers <= patch_layers);
  return true;
}

BandPainter::Reach BandPainter::reach_of(const SampleBox& box) const {
  Reach reach;
  reach.frames = frames_near(table_, box);
  if (thinning_.rest != nullptr) reach.rest = frames_near(*thinning_.rest, box);
  return reach;
}

void BandPainter::paint_strips(const Lattice& lattice, const std::vector<Strip>& strips,
                               const TileSize& size) {
  struct Place {
    const Strip* strip;
    int a, width;
  };
  std::vector<Place> places;
  for (const Strip& strip : strips) {
    for (int a = 0; a < strip.width; a += size.across)
      places.push_back({&strip, strip.a + a, std::min(size.across, strip.width - a)});
  }
  const auto height = [&](const Strip& strip) { return std::min(size.down, lattice.rows - strip.b); };
  Reach reach;
  const auto open = [&](Tile& tile, std::size_t i) {
    if (i == places.size()) return false;
    const Strip& strip = *places[i].strip;
    if (places[i].a == strip.a)
      reach = reach_of(box_of({strip.a, strip.b, 0, strip.width, height(strip), lattice.layers}));
    return !reach.frames.empty() && open_tile(tile, lattice, reach, places[i].a, strip.b, size);
  };
  bool opened = open(tile_, 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (stopped()) return;
    const bool next_opened = open(next_tile_, i + 1);
    const auto& [strip, a, width] = places[i];
    if (opened) {
      paint_tile(lattice);
    } else {
      blank({a, strip->b, 0, width, height(*strip), lattice.layers});
    }
    std::swap(tile_, next_tile_);
    opened = next_opened;
  }
}

void BandPainter::paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first,
                              int last) {
  tile_.table = &table_;
  tile_.shape = LaneShape{patch_lanes};
  const int end = std::min(a + patch_lanes, bundle.samples);
  tile_.grid = lane_grid(tile_.shape);
  const BlockBox block = box_of(bundle, {first, last, a, end});
  if (block.empty) return;
  cull(table_, frames, block.box, interpolation(), tile_.candidates);
  if (tile_.candidates.empty()) return;
  std::vector<int> near;
  for (const Candidate& c : tile_.candidates) near.push_back(c.frame);
  Lattice steps;
  steps.per_sample = bundle.step.v;
  tile_.turned = false;
  tile_.place_frames(steps, 0, 0);
  tile_.make_patches(steps, linear_ ? 2 : 1);
  std::vector<Candidate> candidates;
  std::vector<const PatchFrame*> patch_frames;
  const LaneMask lanes = existing_lanes(tile_.shape, end - a, 1);
  place_.shape = tile_.shape;
  place_.sample_step = bundle.step.v;
  place_.row_step.setZero();
  for (int row = first; row < last && !stopped(); ++row) {
    const BlockBox box = box_of(bundle, {row, row + 1, a, end});
    if (box.empty) continue;
    cull(table_, near, box.box, interpolation(), candidates);
    if (candidates.empty()) continue;
    patch_frames.clear();
    for (const Candidate& c : candidates)
      patch_frames.push_back(&tile_.frames[tile_.index_of(c.frame)].patch);
    totals_.clear();
    for (int l = 0; l < bundle.layers; l += patch_layers) {
      if (l > 0) totals_.next_piece();
      place_.layers = std::min(patch_layers, bundle.layers - l);
      for (int i = 0; i < place_.layers; ++i) {
        const std::size_t line = static_cast<std::size_t>(row) * bundle.layers + l + i;
        const bool present = bundle.present.empty() || bundle.present[line] != 0;
        // An absent line's start may be anything: it must not be computed with.
        const Eigen::Vector3d p =
            present ? Eigen::Vector3d(bundle.starts[line].v + a * bundle.step.v) : box.box.centre;
        place_.x[i] = p.x();
        place_.y[i] = p.y();
        place_.z[i] = p.z();
        place_.lanes[i] = present ? lanes : 0;
      }
      paint_place(candidates, patch_frames);
    }
    totals_.store(*image_, a, row, tile_.shape);
  }
}

}  // namespace sonoband
