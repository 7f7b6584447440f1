#include "core/reslice/band_painter.h"

#include <algorithm>
#include <utility>

#include "core/reslice/patch_kernels.h"

namespace sonoband {
namespace {

// Above so many candidates a patch of many layers is cheaper in halves.
constexpr std::size_t many_candidates = 10;

}  // namespace

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

// What each candidate gives to some layers of place_.
void BandPainter::paint_shares(const std::vector<Candidate>& candidates,
                               const std::vector<const PatchFrame*>& frames, const LayerRange& range) {
  if (linear_) {
    for (std::size_t c = 0; c < candidates.size(); ++c) blend_shares(candidates, frames, c, -1, range);
    for (const auto& [earlier, later] : winners_.meetings())
      blend_shares(candidates, frames, later, static_cast<int>(earlier), range);
    return;
  }
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Winners::Share& s = winners_.share(c);
    const int first = std::max(s.first, range.low), last = std::min(s.last, range.high);
    if (first >= last) continue;
    patch_kernels().take(*frames[c], s.x.data() + first, s.y.data() + first, s.wins.data() + first,
                         last - first, rule_, totals_.piece());
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
      if (apart()) continue;
      store({a - tile_.block.a, b - tile_.block.b, region.depth, existing_lanes(shape, width, height)});
    }
  }
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

}  // namespace sonoband
