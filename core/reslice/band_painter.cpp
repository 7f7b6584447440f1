#include "core/reslice/band_painter.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/reslice/bilinear.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Room for the rounding of 32-bit floats; ties go the written way.
constexpr double float_tie_mm = 1e-5;
// Above so many candidates a patch of many layers is cheaper in halves.
constexpr std::size_t many_candidates = 10;

LayerThresholds constant_thresholds(bool holds) {
  LayerThresholds t;
  t.least = t.greatest = holds ? 0 : 255;
  t.layer.fill(static_cast<std::uint8_t>(t.least));
  return t;
}

const LayerThresholds always_holds = constant_thresholds(true);
const LayerThresholds never_holds = constant_thresholds(false);

AffineScalar plus(AffineScalar f, double offset) {
  f.offset += offset;
  return f;
}

}  // namespace

BandPainter::Boundary BandPainter::boundary(const Lattice& lattice, const AffineScalar& value, int l,
                                            int depth) const {
  const double per_sample = value.gradient.dot(lattice.per_sample);
  const double per_row = value.gradient.dot(lattice.per_row);
  const double per_layer = value.gradient.dot(lattice.per_layer);
  const double half_a = (tile_.shape.across - 1) / 2.0, half_b = (tile_.shape.down() - 1) / 2.0;
  const double half_l = (depth - 1) / 2.0;
  Boundary result;
  result.at_tile = {static_cast<float>(value.at(lattice.at(tile_.block.a, tile_.block.b, l))),
                    static_cast<float>(per_sample), static_cast<float>(per_row),
                    static_cast<float>(per_layer)};
  result.centre = static_cast<float>(half_a * per_sample + half_b * per_row + half_l * per_layer);
  result.extent = static_cast<float>(half_a * std::abs(per_sample) + half_b * std::abs(per_row) +
                                     half_l * std::abs(per_layer));
  return result;
}

void BandPainter::lay_out(const Lattice& lattice, const Chain& chain,
                          const std::vector<Candidate>& candidates, int l, int depth, Cells& cells) const {
  cells.members.clear();
  cells.boundaries.clear();
  const std::size_t members = chain.members.size();
  const auto entry = [&](std::size_t m) -> const FrameEntry& {
    return table_.frames[candidates[chain.members[m]].frame];
  };
  const auto z = [&](std::size_t m) { return oriented_z(entry(m)); };
  const auto reach = [&](std::size_t m) { return entry(m).gap_mm + tie_mm + float_tie_mm; };
  for (const int m : chain.members) cells.members.push_back(tile_.index_of(candidates[m].frame));
  Boundary always, never;
  always.always = true;
  never.never = true;
  // First begins where the first frame reaches, z >= -d; the last ends where z > d.
  cells.boundaries.push_back(chain.first_ends ? boundary(lattice, plus(z(0), reach(0)), l, depth) : always);
  for (std::size_t m = 0; m < members; ++m) {
    if (linear_) {
      cells.boundaries.push_back(boundary(lattice, z(m), l, depth));
    } else if (m > 0) {
      const AffineScalar before = z(m - 1), after = z(m);
      const bool later = cells.members[m] > cells.members[m - 1];
      cells.boundaries.push_back(
          boundary(lattice,
                   {before.gradient + after.gradient,
                    before.offset + after.offset + (later ? float_tie_mm : -float_tie_mm)},
                   l, depth));
    }
  }
  cells.boundaries.push_back(
      chain.last_ends ? boundary(lattice, plus(z(members - 1), -reach(members - 1)), l, depth) : never);
}

void BandPainter::paint_cells(const Cells& cells, const Patch& patch) {
  const int count = static_cast<int>(cells.boundaries.size()) - 1;
  const auto value_at = [&](int j) {
    const PatchFunction& f = cells.boundaries[j].at_tile;
    return f.first + f.per_sample * static_cast<float>(patch.da) + f.per_row * static_cast<float>(patch.db);
  };
  // Cells the patch meets: from the last boundary that holds everywhere to the first that holds nowhere.
  int first = 0, end = count;
  for (int j = 1; j <= count; ++j) {
    const Boundary& boundary = cells.boundaries[j];
    if (boundary.never) break;
    const float centre = value_at(j) + boundary.centre;
    if (centre - boundary.extent >= 0) {
      first = j;
    } else if (centre + boundary.extent < 0) {
      end = j;
      break;
    }
  }
  if (first >= count) return;
  const auto settle = [&](int j, LayerThresholds& scratch) -> const LayerThresholds* {
    const Boundary& boundary = cells.boundaries[j];
    if (boundary.always || (j == first && j > 0)) return &always_holds;
    if (boundary.never || (j == end && j < count)) return &never_holds;
    PatchFunction f = boundary.at_tile;
    f.first = value_at(j);
    patch_kernels().thresholds(grid_, f, scratch);
    return &scratch;
  };
  std::array<LayerThresholds, 2> scratch;
  std::array<LaneMask, patch_layers> masks;
  const LayerThresholds* from = settle(first, scratch[0]);
  for (int cell = first; cell < end; ++cell) {
    const LayerThresholds* to = settle(cell + 1, scratch[(cell - first + 1) % 2]);
    int low = 0, high = patch.depth;
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
      patch_kernels().between(*from, *to, patch.lanes, low, high, masks.data());
      take_cell(cells, cell, patch, low, high, masks.data());
    }
    from = to;
  }
}

// Layers low <= l < high of the patch; masks from low on.
void BandPainter::take_cell(const Cells& cells, int cell, const Patch& patch, int low, int high,
                            LaneMask* masks) {
  const int layers = high - low, layer = patch.l + low;
  const auto positions = [&](const TileFrame& t, FixedPx offset, FixedPx* x, FixedPx* y) {
    FixedPx at_x = t.x + patch.da * t.x_per_sample + patch.db * t.x_per_row + layer * t.x_per_layer + offset;
    FixedPx at_y = t.y + patch.da * t.y_per_sample + patch.db * t.y_per_row + layer * t.y_per_layer + offset;
    for (int i = 0; i < layers; ++i, at_x += t.x_per_layer, at_y += t.y_per_layer) {
      x[i] = at_x;
      y[i] = at_y;
    }
  };
  if (!linear_) {
    std::array<FixedPx, patch_layers> x, y;
    const TileFrame& t = tile_.frames[cells.members[cell]];
    positions(t, 0, x.data(), y.data());
    patch_kernels().take(t.patch, x.data(), y.data(), masks, layers, rule_, totals_.piece());
    return;
  }
  const auto side = [&](int member, BlendSide& out) {
    const TileFrame& t = tile_.frames[cells.members[member]];
    out.frame = tile_.candidates[cells.members[member]].frame;
    out.patch = &t.patch;
    positions(t, foot_from_position, out.x.data(), out.y.data());
    // The member's plane is the boundary after its cell.
    const PatchFunction& z = cells.boundaries[member + 1].at_tile;
    const float first =
        z.first + z.per_sample * static_cast<float>(patch.da) + z.per_row * static_cast<float>(patch.db);
    for (int i = 0; i < layers; ++i) out.z[i] = first + z.per_layer * static_cast<float>(low + i);
    out.z_per_sample = z.per_sample;
    out.z_per_row = z.per_row;
  };
  const int members = static_cast<int>(cells.members.size());
  if (cell > 0) side(cell - 1, side_a_);
  if (cell < members) side(cell, cell > 0 ? side_b_ : side_a_);
  blend(side_a_, cell > 0 && cell < members ? &side_b_ : nullptr, layers, masks);
}

void BandPainter::blend(BlendSide& a, BlendSide* b, int layers, LaneMask* masks) {
  // Lanes the kernel does not cover: colours, and taps the mask takes away.
  std::array<LaneMask, patch_layers> odd{};
  if (table_.kind == PixelKind::doppler) {
    std::copy_n(masks, layers, odd.data());
    std::fill_n(masks, layers, LaneMask{0});
  } else if (!table_.mask.empty()) {
    std::copy_n(masks, layers, odd.data());
    for (const BlendSide* s : {static_cast<const BlendSide*>(&a), static_cast<const BlendSide*>(b)}) {
      if (s == nullptr) continue;
      patch_kernels().taps_inside(*s->patch, table_.mask.data, table_.mask.stride, s->x.data(), s->y.data(),
                                  layers, masks);
    }
    for (int l = 0; l < layers; ++l) odd[l] &= ~masks[l];
  }
  for (int l = 0; l < layers; ++l) {
    for (LaneMask rest = odd[l]; rest != 0; rest &= rest - 1) blend_lane(a, b, l, std::countr_zero(rest));
  }
  if (b != nullptr) {
    patch_kernels().blend(grid_, a.side(), b->side(), masks, layers, rule_, totals_.piece());
    return;
  }
  // Alone: blended with itself, whatever the weights.
  BlendSide& twin = side_b_;
  twin.z.fill(-1);
  twin.z_per_sample = twin.z_per_row = 0;
  LinearSide mine = a.side(), other = twin.side();
  other.frame = mine.frame;
  other.x = mine.x;
  other.y = mine.y;
  a.z.fill(0);
  mine.z_per_sample = mine.z_per_row = 0;
  patch_kernels().blend(grid_, mine, other, masks, layers, rule_, totals_.piece());
}

void BandPainter::blend_lane(const BlendSide& a, const BlendSide* b, int l, int lane) {
  const auto z = [&](const BlendSide& s) {
    return static_cast<double>(s.z[l]) + static_cast<double>(s.z_per_sample) * grid_.a[lane] +
           static_cast<double>(s.z_per_row) * grid_.b[lane];
  };
  TapBlend taps(table_);
  const auto add = [&](const BlendSide& s, double share) {
    const double x = static_cast<double>(s.x[l]) / fixed_per_px + s.patch->offset_x[lane] / 65536.0;
    const double y = static_cast<double>(s.y[l]) / fixed_per_px + s.patch->offset_y[lane] / 65536.0;
    taps.add(table_.frames[s.frame], x, y, share);
  };
  const double za = std::abs(z(a)), zb = b != nullptr ? std::abs(z(*b)) : 0;
  const double share = b != nullptr && za > 0 ? zb / (za + zb) : 1;
  if (share > 0) add(a, share);
  if (share < 1) add(*b, 1 - share);
  const std::uint8_t value = taps.value();
  PatchSums& sums = totals_.piece();
  ++sums.count[lane];
  sums.extreme[lane] =
      rule_ == Rule::minimum ? std::min(sums.extreme[lane], value) : std::max(sums.extreme[lane], value);
  if (rule_ == Rule::mean_doppler && doppler::is_colour(value)) {
    ++sums.coloured[lane];
    sums.velocity[lane] = static_cast<std::int16_t>(sums.velocity[lane] + doppler::velocity(value));
  } else {
    sums.sum[lane] = static_cast<std::uint16_t>(sums.sum[lane] + value);
  }
}

// Blends candidate a's lanes with b's on the other side; b < 0: those of a with nothing there.
void BandPainter::blend_shares(const std::vector<Candidate>& candidates,
                               const std::vector<const PatchFrame*>& frames, std::size_t a, int b) {
  const Winners::Share& of_a = winners_.share(a);
  int first = of_a.first, last = of_a.last;
  if (b >= 0) {
    first = std::max(first, winners_.share(b).first);
    last = std::min(last, winners_.share(b).last);
  }
  if (first >= last) return;
  std::array<LaneMask, patch_layers> masks;
  LaneMask any = 0;
  for (int l = first; l < last; ++l) {
    LaneMask m = of_a.wins[l];
    if (b >= 0) {
      const Winners::Share& of_b = winners_.share(b);
      m &= of_b.side_wins[l] & (of_a.positive[l] ^ of_b.positive[l]);
    } else {
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        const Winners::Share& other = winners_.share(c);
        if (l >= other.first && l < other.last)
          m &= ~(other.side_wins[l] & (of_a.positive[l] ^ other.positive[l]));
      }
    }
    masks[l - first] = m;
    any |= m;
  }
  if (any == 0) return;
  const auto side = [&](std::size_t c, BlendSide& out) {
    const Winners::Share& s = winners_.share(c);
    out.frame = candidates[c].frame;
    out.patch = frames[c];
    for (int l = first; l < last; ++l) {
      out.x[l - first] = s.x[l] + foot_from_position;
      out.y[l - first] = s.y[l] + foot_from_position;
      out.z[l - first] = static_cast<float>(s.z[l]);
    }
    out.z_per_sample = static_cast<float>(s.z_per_sample);
    out.z_per_row = static_cast<float>(s.z_per_row);
  };
  side(a, side_a_);
  if (b >= 0) side(b, side_b_);
  blend(side_a_, b >= 0 ? &side_b_ : nullptr, last - first, masks.data());
}

// Any geometry, at place_.
void BandPainter::paint_place(const std::vector<Candidate>& candidates,
                              const std::vector<const PatchFrame*>& frames) {
  winners_.find(table_, candidates, frames, place_, grid_, interpolation());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Winners::Share& s = winners_.share(c);
    if (s.first >= s.last) continue;
    if (linear_) {
      for (int other = -1; other < static_cast<int>(candidates.size()); ++other)
        if (other != static_cast<int>(c)) blend_shares(candidates, frames, c, other);
    } else {
      patch_kernels().take(*frames[c], s.x.data() + s.first, s.y.data() + s.first, s.wins.data() + s.first,
                           s.last - s.first, rule_, totals_.piece());
    }
  }
}

// A patch of a tile whose frames are no chain throughout.
void BandPainter::paint_block(const Lattice& lattice, const LatticeBlock& block) {
  std::vector<int> frames;
  for (const Candidate& c : tile_.candidates) frames.push_back(c.frame);
  std::vector<Candidate> candidates;
  const SampleBox box = box_of(lattice, block);
  cull(table_, frames, box, interpolation(), candidates);
  if (candidates.empty()) return;
  const LaneMask lanes = existing_lanes(tile_.shape, block.width, block.height);
  Chain chain;
  if (make_chain(table_, candidates, box, chain)) {
    lay_out(lattice, chain, candidates, block.l, block.depth, patch_cells_);
    paint_cells(patch_cells_,
                {block.a - tile_.block.a, block.b - tile_.block.b, block.l, block.depth, lanes});
    return;
  }
  if (candidates.size() > many_candidates && block.depth > 8) {
    LatticeBlock half = block;
    half.depth = block.depth / 2;
    paint_block(lattice, half);
    half.l += half.depth;
    half.depth = block.depth - half.depth;
    paint_block(lattice, half);
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
  paint_place(candidates, patch_frames);
}

void BandPainter::paint_tile(const Lattice& lattice, const std::vector<int>& frames, int a, int b) {
  if (stopped() || !tile_.open(table_, lattice, frames, interpolation(), a, b)) return;
  const LaneShape shape = tile_.shape;
  grid_ = lane_grid(shape);
  Chain chain;
  const bool chained =
      lattice.layers <= patch_layers && make_chain(table_, tile_.candidates, tile_.box, chain);
  if (chained) lay_out(lattice, chain, tile_.candidates, 0, lattice.layers, tile_cells_);
  for (int db = 0; db < tile_.block.height; db += shape.down()) {
    if (stopped()) return;
    for (int da = 0; da < tile_.block.width; da += shape.across) {
      const int width = std::min(shape.across, tile_.block.width - da);
      const int height = std::min(shape.down(), tile_.block.height - db);
      totals_.clear();
      if (chained) {
        paint_cells(tile_cells_, {da, db, 0, lattice.layers, existing_lanes(shape, width, height)});
      } else {
        for (int l = 0; l < lattice.layers; l += patch_layers) {
          if (l > 0) totals_.next_piece();
          paint_block(lattice,
                      {a + da, b + db, l, width, height, std::min(patch_layers, lattice.layers - l)});
        }
      }
      totals_.store(image_, a + da, b + db, shape);
    }
  }
}

void BandPainter::paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first,
                              int last) {
  tile_.shape = LaneShape{patch_lanes};
  const int end = std::min(a + patch_lanes, bundle.samples);
  grid_ = lane_grid(tile_.shape);
  const BlockBox block = box_of(bundle, {first, last, a, end});
  if (block.empty) return;
  cull(table_, frames, block.box, interpolation(), tile_.candidates);
  if (tile_.candidates.empty()) return;
  std::vector<int> near;
  for (const Candidate& c : tile_.candidates) near.push_back(c.frame);
  Lattice steps;
  steps.per_sample = bundle.step.v;
  tile_.make_frames(table_, steps, 0, 0, linear_ ? 2 : 1);
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
    totals_.store(image_, a, row, tile_.shape);
  }
}

}  // namespace sonoband
