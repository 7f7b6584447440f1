#include "core/reslice/tile.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/chain_cells.h"
#include "core/reslice/patch_shape.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Ends of ranges that floats put beyond a frame's reach count.
double own_reach(const FrameEntry& frame) {
  return frame.gap_mm + tie_mm + 1e-3;
}

// The picture that is kept turned, with its axes.
FrameEntry turned_entry(const FrameEntry& frame) {
  FrameEntry turned = frame;
  turned.pixels = frame.turned;
  turned.stride = frame.turned_stride;
  std::swap(turned.width, turned.height);
  return turned;
}

FixedPx fixed(double px) {
  return std::llround(px * fixed_per_px);
}

}  // namespace

TileSize tile_size(const FrameTable& seen, int layers, Interpolation interpolation) {
  if (interpolation == Interpolation::linear) return {};
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  for (const FrameEntry& f : seen.frames) change += f.z_mm.gradient.cwiseAbs();
  // By how much distances vary in a tile, hence how many frames it has.
  const auto range = [&](const TileSize& size) {
    return change.dot(Eigen::Vector3d(size.across, size.down, layers));
  };
  // Longer tiles have more edges for what they spare.
  constexpr double little = 0.6;
  const TileSize square, usual{128, 64}, wide{128, 32}, tall{32, 128}, large{256, 64};
  const TileSize& longer = range(wide) < range(tall) ? wide : tall;
  if (range(longer) < little * range(square)) return longer;
  // Along planes in which frames hardly change along a line: parallel ones, or tilted about it.
  constexpr double hardly_more = 1.25;
  return range(large) < hardly_more * range(square) ? large : usual;
}

LaneMask existing_lanes(LaneShape shape, int width, int height) {
  if (width >= shape.across && height >= shape.down()) return ~LaneMask{0};
  LaneMask lanes = 0;
  for (int k = 0; k < patch_lanes; ++k)
    if (k % shape.across < width && k / shape.across < height) lanes |= LaneMask{1} << k;
  return lanes;
}

LaneMask existing_lanes(const LaneGrid& grid, int a, int b, int width, int height) {
  if (a + grid.least_a >= 0 && a + grid.greatest_a < width && b + grid.least_b >= 0 &&
      b + grid.greatest_b < height)
    return ~LaneMask{0};
  LaneMask lanes = 0;
  for (int i = 0; i < grid.run_count; ++i) {
    const LaneRun& run = grid.runs[i];
    if (b + run.b < 0 || b + run.b >= height) continue;
    const int first = std::max(0, -(a + run.a)), last = std::min(run.count, width - (a + run.a));
    if (first < last) lanes |= ~LaneMask{0} >> (patch_lanes - (last - first)) << (run.lane + first);
  }
  return lanes;
}

void Tile::place_frames(const Lattice& lattice, int a, int b) {
  if (frames.size() < candidates.size()) frames.resize(candidates.size());
  const Eigen::Vector3d origin = lattice.at(a, b, 0);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const FrameEntry& f = table->frames[candidates[c].frame];
    ChainFrame& at = frames[c].at;
    at.x = fixed_position(f.x_px.at(origin));
    at.y = fixed_position(f.y_px.at(origin));
    at.x_per_sample = fixed(f.x_px.gradient.dot(lattice.per_sample));
    at.x_per_row = fixed(f.x_px.gradient.dot(lattice.per_row));
    at.x_per_layer = fixed(f.x_px.gradient.dot(lattice.per_layer));
    at.y_per_sample = fixed(f.y_px.gradient.dot(lattice.per_sample));
    at.y_per_row = fixed(f.y_px.gradient.dot(lattice.per_row));
    at.y_per_layer = fixed(f.y_px.gradient.dot(lattice.per_layer));
  }
}

RowsAhead Tile::rows_of(std::size_t c) const {
  const FrameEntry& f = table->frames[candidates[c].frame];
  return turned_kept ? rows_ahead(turned_entry(f), turned_part(parts[c])) : rows_ahead(f, parts[c]);
}

void Tile::make_patches(const Lattice& lattice, int taps) {
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const FrameEntry& f = table->frames[candidates[c].frame];
    const FootSteps steps{f.x_px.gradient.dot(lattice.per_sample), f.x_px.gradient.dot(lattice.per_row),
                          f.y_px.gradient.dot(lattice.per_sample), f.y_px.gradient.dot(lattice.per_row)};
    const FootSteps turned_steps{steps.y_per_sample, steps.y_per_row, steps.x_per_sample, steps.x_per_row};
    if (turned && turned_kept) {
      make_patch_frame(turned_entry(f), turned_steps, grid, taps, frames[c].patch);
    } else if (turned) {
      make_patch_frame(turned_parts.picture(c), turned_steps, grid, taps, frames[c].patch);
      turned_parts.bound(c, frames[c].patch);
    } else {
      make_patch_frame(f, steps, grid, taps, frames[c].patch);
      if (candidates[c].borders_mask) {
        frames[c].patch.mask = table->mask.data;
        frames[c].patch.mask_stride = table->mask.stride;
      }
    }
  }
}

// Kernels take turned frames only where they take the whole tile as one chain.
bool Tile::may_turn(Interpolation interpolation) const {
  if (!is_chain || block.depth > patch_layers) return false;
  const bool linear = interpolation == Interpolation::linear;
  if (linear && table->kind != PixelKind::grey) return false;
  return std::all_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
    const FrameEntry& f = table->frames[c.frame];
    return f.width >= least_turned_px && !c.borders_mask && (!linear || all_taps_kept(*table, f, box));
  });
}

int Tile::index_of(int frame) const {
  const auto found = std::lower_bound(candidates.begin(), candidates.end(), frame,
                                      [](const Candidate& c, int f) { return c.frame < f; });
  return static_cast<int>(found - candidates.begin());
}

void Tile::keep_chain_only() {
  std::vector<int> members = chain.members;
  std::sort(members.begin(), members.end());
  const auto place = [&](int m) {
    return static_cast<int>(std::lower_bound(members.begin(), members.end(), m) - members.begin());
  };
  for (std::size_t i = 0; i < members.size(); ++i) candidates[i] = candidates[members[i]];
  candidates.resize(members.size());
  for (int& m : chain.members) m = place(m);
}

bool Tile::find(const FrameTable& frame_table, const Lattice& lattice, const std::vector<int>& near,
                Interpolation interpolation, bool may_end, int a, int b, const TileSize& size) {
  table = &frame_table;
  block = {a,
           b,
           0,
           std::min(size.across, lattice.samples - a),
           std::min(size.down, lattice.rows - b),
           lattice.layers};
  box = box_of(block);
  cull(frame_table, near, box, interpolation, candidates);
  is_chain = may_end ? make_ending_chain(frame_table, candidates, box, chain)
                     : make_chain(frame_table, candidates, box, chain);
  return !candidates.empty();
}

void Tile::thin(Interpolation interpolation, const OutputPixel& pixel, LeftOut& count) {
  thin_chain(*table, candidates, box, pixel, interpolation, chain);
  count.add(candidates.size(), chain.members.size());
  keep_chain_only();
}

void Tile::open(const Lattice& lattice, Interpolation interpolation, bool may_reshape) {
  place_frames(lattice, block.a, block.b);
  PatchFreedom may{may_reshape && is_chain, may_reshape && may_turn(interpolation), 0};
  std::vector<double> reaches;
  if (may.turn) reaches = chain_reaches(*table, candidates, chain, box, interpolation);
  parts.clear();
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const FrameEntry& f = table->frames[candidates[c].frame];
    // Frames whose neighbours' pictures end take samples in all their reach.
    const double reach = !may.turn ? f.gap_mm : chain.whole ? reaches[c] : std::max(reaches[c], own_reach(f));
    parts.push_back(part_within(reach, f, candidates[c], lattice, block, frames[c].at));
    may.turned_pixels += static_cast<double>(parts.back().columns()) * parts.back().rows();
  }
  // Does not depend on what is kept: linear is not the same to the last bit along rows and along columns.
  const PatchChoice choice = choose_patches(*this, lattice, interpolation, may);
  shape = choice.shape;
  turned = choice.turned;
  grid = lane_grid(shape);
  turned_kept = turned && std::all_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
                  return table->frames[c.frame].turned != nullptr;
                });
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (turned_kept) turn_positions(frames[c].at);
  }
  if (parts_to_turn()) {
    turned_parts.clear();
    for (std::size_t c = 0; c < candidates.size(); ++c)
      turned_parts.add(table->frames[candidates[c].frame], parts[c], frames[c].at);
    turned_parts.lay_out();
  }
  make_patches(lattice, interpolation == Interpolation::linear ? 2 : 1);
}

}  // namespace sonoband
