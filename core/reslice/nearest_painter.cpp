#include "core/reslice/nearest_painter.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Room for the rounding of 32-bit floats; ties go the written way.
constexpr double float_tie_mm = 1e-5;
// Above so many candidates a patch of many layers is cheaper in halves.
constexpr std::size_t many_candidates = 10;

FixedPx fixed(double px) {
  return std::llround(px * fixed_per_px);
}

LaneMask existing_lanes(LaneShape shape, int width, int height) {
  if (width >= shape.across && height >= shape.down()) return ~LaneMask{0};
  LaneMask lanes = 0;
  for (int k = 0; k < patch_lanes; ++k)
    if (k % shape.across < width && k / shape.across < height) lanes |= LaneMask{1} << k;
  return lanes;
}

LayerThresholds constant_thresholds(bool holds) {
  LayerThresholds t;
  t.least = t.greatest = holds ? 0 : 255;
  t.layer.fill(static_cast<std::uint8_t>(t.least));
  return t;
}

const LayerThresholds always_holds = constant_thresholds(true);
const LayerThresholds never_holds = constant_thresholds(false);

}  // namespace

LaneShape NearestPainter::choose_shape(const Lattice& lattice) const {
  const Candidate& middle = *std::min_element(
      candidates_.begin(), candidates_.end(),
      [](const Candidate& a, const Candidate& b) { return std::abs(a.z_centre) < std::abs(b.z_centre); });
  const FrameEntry& f = table_.frames[middle.frame];
  const auto per = [&](const AffineScalar& g, const Eigen::Vector3d& step) {
    return std::abs(g.gradient.dot(step));
  };
  const double xa = per(f.x_px, lattice.per_sample), xb = per(f.x_px, lattice.per_row);
  const double ya = per(f.y_px, lattice.per_sample), yb = per(f.y_px, lattice.per_row);
  const double za = per(f.z_mm, lattice.per_sample), zb = per(f.z_mm, lattice.per_row);
  const double xl = per(f.x_px, lattice.per_layer), yl = per(f.y_px, lattice.per_layer);
  const double spacing = std::max(2 * f.gap_mm, 1e-3);
  const double frames_per_layer = per(f.z_mm, lattice.per_layer) / spacing;
  LaneShape best;
  double least = 1e30;
  for (int across = patch_lanes; across >= 1; across /= 2) {
    const LaneShape shape{across};
    const int w = shape.across - 1, h = shape.down() - 1;
    const double columns = xa * w + xb * h, rows = ya * w + yb * h;
    // In instructions or so, of one frame and layer.
    double cost = 150;
    if (columns < 125 && rows < 24) cost = 12 + 5 * (rows + 1);
    if (columns < 13.5 && rows < 13.5) {
      const double reloads = std::max({xl / (14.5 - columns), yl / (14.5 - rows), frames_per_layer});
      cost = std::min(cost, 22 + 30 * std::min(1.0, reloads));
    }
    cost *= 1 + (za * w + zb * h) / spacing;
    if (cost < least) {
      least = cost;
      best = shape;
    }
  }
  return best;
}

void NearestPainter::make_tile_frames(const Lattice& lattice, int a, int b, LaneShape shape) {
  if (tile_frames_.size() < candidates_.size()) tile_frames_.resize(candidates_.size());
  const Eigen::Vector3d origin = lattice.at(a, b, 0);
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const FrameEntry& f = table_.frames[candidates_[c].frame];
    TileFrame& t = tile_frames_[c];
    const FootSteps steps{f.x_px.gradient.dot(lattice.per_sample), f.x_px.gradient.dot(lattice.per_row),
                          f.y_px.gradient.dot(lattice.per_sample), f.y_px.gradient.dot(lattice.per_row)};
    make_patch_frame(f, steps, shape, t.patch);
    t.x = fixed_position(f.x_px.at(origin));
    t.y = fixed_position(f.y_px.at(origin));
    t.x_per_sample = fixed(steps.x_per_sample);
    t.x_per_row = fixed(steps.x_per_row);
    t.x_per_layer = fixed(f.x_px.gradient.dot(lattice.per_layer));
    t.y_per_sample = fixed(steps.y_per_sample);
    t.y_per_row = fixed(steps.y_per_row);
    t.y_per_layer = fixed(f.y_px.gradient.dot(lattice.per_layer));
  }
}

void NearestPainter::make_boundaries(const Lattice& lattice, const Chain& chain,
                                     const std::vector<Candidate>& candidates, int a, int b, int l, int depth,
                                     LaneShape shape) {
  const std::size_t members = chain.members.size();
  boundaries_.resize(members + 1);
  const Eigen::Vector3d origin = lattice.at(a, b, l);
  const auto frame_of = [&](std::size_t m) { return candidates[chain.members[m]].frame; };
  for (std::size_t j = 0; j <= members; ++j) {
    Boundary& boundary = boundaries_[j];
    boundary = {};
    if (j == 0 && !chain.first_ends) {
      boundary.always = true;
      continue;
    }
    if (j == members && !chain.last_ends) {
      boundary.never = true;
      continue;
    }
    AffineScalar value;
    if (j == 0) {  // z >= -d
      value = oriented_z(table_.frames[frame_of(0)]);
      value.offset += table_.frames[frame_of(0)].gap_mm + tie_mm + float_tie_mm;
    } else if (j == members) {  // z > d
      value = oriented_z(table_.frames[frame_of(j - 1)]);
      value.offset -= table_.frames[frame_of(j - 1)].gap_mm + tie_mm + float_tie_mm;
    } else {
      const AffineScalar before = oriented_z(table_.frames[frame_of(j - 1)]);
      const AffineScalar after = oriented_z(table_.frames[frame_of(j)]);
      const bool later = frame_of(j) > frame_of(j - 1);
      value = {before.gradient + after.gradient,
               before.offset + after.offset + (later ? float_tie_mm : -float_tie_mm)};
    }
    const double per_sample = value.gradient.dot(lattice.per_sample);
    const double per_row = value.gradient.dot(lattice.per_row);
    const double per_layer = value.gradient.dot(lattice.per_layer);
    boundary.at_tile = {static_cast<float>(value.at(origin)), static_cast<float>(per_sample),
                        static_cast<float>(per_row), static_cast<float>(per_layer)};
    const double half_a = (shape.across - 1) / 2.0, half_b = (shape.down() - 1) / 2.0,
                 half_l = (depth - 1) / 2.0;
    boundary.centre = static_cast<float>(half_a * per_sample + half_b * per_row + half_l * per_layer);
    boundary.extent = static_cast<float>(half_a * std::abs(per_sample) + half_b * std::abs(per_row) +
                                         half_l * std::abs(per_layer));
  }
}

// Patch at (da, db) from the tile's corner; tile_frames[m] is member m's place in tile_frames_.
void NearestPainter::paint_chain(const Chain& chain, const std::vector<int>& tile_frames, int da, int db,
                                 int l, int depth, LaneMask lanes) {
  const int members = static_cast<int>(chain.members.size());
  const auto value_at = [&](int j) {
    const PatchFunction& f = boundaries_[j].at_tile;
    return f.first + f.per_sample * static_cast<float>(da) + f.per_row * static_cast<float>(db);
  };
  // Members the patch meets: from the last boundary that holds everywhere to the first that holds nowhere.
  int first = 0, end = members;
  for (int j = 1; j <= members; ++j) {
    if (boundaries_[j].never) break;
    const float centre = value_at(j) + boundaries_[j].centre;
    if (centre - boundaries_[j].extent >= 0) {
      first = j;
    } else if (centre + boundaries_[j].extent < 0) {
      end = j;
      break;
    }
  }
  if (first >= members) return;
  const auto settle = [&](int j, LayerThresholds& scratch) -> const LayerThresholds* {
    const Boundary& boundary = boundaries_[j];
    if (boundary.always || (j == first && j > 0)) return &always_holds;
    if (boundary.never || (j == end && j < members)) return &never_holds;
    PatchFunction f = boundary.at_tile;
    f.first = value_at(j);
    patch_kernels().thresholds(grid_, f, scratch);
    return &scratch;
  };
  std::array<LayerThresholds, 2> scratch;
  std::array<LaneMask, patch_layers> masks;
  std::array<FixedPx, patch_layers> x, y;
  const LayerThresholds* from = settle(first, scratch[0]);
  for (int m = first; m < end; ++m) {
    const LayerThresholds* to = settle(m + 1, scratch[(m - first + 1) % 2]);
    int low = 0, high = depth;
    if (from->rising) {
      low = std::max(low, from->least);
    } else {
      high = std::min(high, from->greatest);
    }
    if (to->rising) {
      high = std::min(high, to->greatest);
    } else {
      low = std::max(low, to->least);
    }
    if (low < high) {
      patch_kernels().between(*from, *to, lanes, low, high, masks.data());
      const TileFrame& t = tile_frames_[tile_frames[m]];
      FixedPx at_x = t.x + da * t.x_per_sample + db * t.x_per_row + (l + low) * t.x_per_layer;
      FixedPx at_y = t.y + da * t.y_per_sample + db * t.y_per_row + (l + low) * t.y_per_layer;
      for (int i = 0; i < high - low; ++i, at_x += t.x_per_layer, at_y += t.y_per_layer) {
        x[i] = at_x;
        y[i] = at_y;
      }
      patch_kernels().take(t.patch, x.data(), y.data(), masks.data(), high - low, rule_, totals_.piece());
    }
    from = to;
  }
}

void NearestPainter::paint_general(const std::vector<Candidate>& candidates,
                                   const std::vector<const PatchFrame*>& frames, const PatchPlace& place) {
  winners_.find(table_, candidates, frames, place, grid_);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Winners::Share& s = winners_.share(c);
    if (s.first >= s.last) continue;
    patch_kernels().take(*frames[c], s.x.data() + s.first, s.y.data() + s.first, s.wins.data() + s.first,
                         s.last - s.first, rule_, totals_.piece());
  }
}

void NearestPainter::paint_patch(const Lattice& lattice, const LatticeBlock& block, int tile_a, int tile_b,
                                 LaneShape shape) {
  // Candidates of the tile, ascending; so are those of the patch.
  std::vector<int> frames;
  for (const Candidate& c : candidates_) frames.push_back(c.frame);
  std::vector<Candidate> candidates;
  const SampleBox box = box_of(lattice, block);
  cull(table_, frames, box, Interpolation::nearest, candidates);
  if (candidates.empty()) return;
  const auto tile_index = [&](const Candidate& c) {
    return static_cast<int>(std::lower_bound(frames.begin(), frames.end(), c.frame) - frames.begin());
  };
  const LaneMask lanes = existing_lanes(shape, block.width, block.height);
  Chain chain;
  if (make_chain(table_, candidates, box, chain)) {
    std::vector<int> tile_frames;
    for (const int m : chain.members) tile_frames.push_back(tile_index(candidates[m]));
    make_boundaries(lattice, chain, candidates, tile_a, tile_b, block.l, block.depth, shape);
    paint_chain(chain, tile_frames, block.a - tile_a, block.b - tile_b, block.l, block.depth, lanes);
    return;
  }
  if (candidates.size() > many_candidates && block.depth > 8) {
    LatticeBlock half = block;
    half.depth = block.depth / 2;
    paint_patch(lattice, half, tile_a, tile_b, shape);
    half.l += half.depth;
    half.depth = block.depth - half.depth;
    paint_patch(lattice, half, tile_a, tile_b, shape);
    return;
  }
  place_.layers = block.depth;
  place_.shape = shape;
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
  for (const Candidate& c : candidates) patch_frames.push_back(&tile_frames_[tile_index(c)].patch);
  paint_general(candidates, patch_frames, place_);
}

void NearestPainter::paint_tile(const Lattice& lattice, const std::vector<int>& frames, int a, int b) {
  const LatticeBlock tile{a,
                          b,
                          0,
                          std::min(tile_pixels, lattice.samples - a),
                          std::min(tile_pixels, lattice.rows - b),
                          lattice.layers};
  const SampleBox box = box_of(lattice, tile);
  cull(table_, frames, box, Interpolation::nearest, candidates_);
  if (candidates_.empty()) return;
  const LaneShape shape = choose_shape(lattice);
  grid_ = lane_grid(shape);
  make_tile_frames(lattice, a, b, shape);
  Chain chain;
  const bool chained = lattice.layers <= patch_layers && make_chain(table_, candidates_, box, chain);
  if (chained) make_boundaries(lattice, chain, candidates_, a, b, 0, lattice.layers, shape);
  for (int db = 0; db < tile.height; db += shape.down()) {
    for (int da = 0; da < tile.width; da += shape.across) {
      const int width = std::min(shape.across, tile.width - da);
      const int height = std::min(shape.down(), tile.height - db);
      totals_.clear();
      if (chained) {
        paint_chain(chain, chain.members, da, db, 0, lattice.layers, existing_lanes(shape, width, height));
      } else {
        for (int l = 0; l < lattice.layers; l += patch_layers) {
          if (l > 0) totals_.next_piece();
          paint_patch(lattice, {a + da, b + db, l, width, height, std::min(patch_layers, lattice.layers - l)},
                      a, b, shape);
        }
      }
      totals_.store(image_, a + da, b + db, shape);
    }
  }
}

void NearestPainter::paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first,
                                 int last) {
  const LaneShape shape{patch_lanes};
  const int end = std::min(a + patch_lanes, bundle.samples);
  grid_ = lane_grid(shape);
  const BlockBox block = box_of(bundle, {first, last, a, end});
  if (block.empty) return;
  cull(table_, frames, block.box, Interpolation::nearest, candidates_);
  if (candidates_.empty()) return;
  std::vector<int> near;
  for (const Candidate& c : candidates_) near.push_back(c.frame);
  Lattice steps;
  steps.per_sample = bundle.step.v;
  make_tile_frames(steps, 0, 0, shape);
  std::vector<Candidate> candidates;
  std::vector<const PatchFrame*> patch_frames;
  const LaneMask lanes = existing_lanes(shape, end - a, 1);
  place_.shape = shape;
  place_.sample_step = bundle.step.v;
  place_.row_step.setZero();
  for (int row = first; row < last; ++row) {
    const BlockBox box = box_of(bundle, {row, row + 1, a, end});
    if (box.empty) continue;
    cull(table_, near, box.box, Interpolation::nearest, candidates);
    if (candidates.empty()) continue;
    patch_frames.clear();
    for (const Candidate& c : candidates) {
      patch_frames.push_back(
          &tile_frames_[std::lower_bound(near.begin(), near.end(), c.frame) - near.begin()].patch);
    }
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
      paint_general(candidates, patch_frames, place_);
    }
    totals_.store(image_, a, row, shape);
  }
}

}  // namespace sonoband
