// Which tiles a painter opens, and when: strips of a plane, rows of a bundle.
#include <algorithm>
#include <utility>

#include "core/reslice/band_painter.h"

namespace sonoband {

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
  if (tile.is_chain && takes_cells() && !tile.parts_to_turn()) {
    const auto& members = tile.chain.members;
    for (std::size_t m = 0; m < std::min(members.size(), cells_ahead); ++m)
      tile.rows_of(members[m]).ask_all();
  } else {
    for (std::size_t c = 0; c < tile.candidates.size(); ++c) tile.rows_of(c).ask_all();
  }
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
