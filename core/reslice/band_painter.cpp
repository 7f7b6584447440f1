#include "core/reslice/band_painter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/reslice/bilinear.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Room for the rounding of 32-bit floats; ties go the written way.
constexpr double float_tie_mm = 1e-5;
// Above so many candidates a patch of many layers is cheaper in halves.
constexpr std::size_t many_candidates = 10;

AffineScalar plus(AffineScalar f, double offset) {
  f.offset += offset;
  return f;
}

}  // namespace

ChainBoundary BandPainter::boundary(const Lattice& lattice, const AffineScalar& value, int l) const {
  const double per_layer = value.gradient.dot(lattice.per_layer);
  ChainBoundary result;
  result.rising = per_layer >= 0;
  // A condition that hardly changes from layer to layer changes beyond the last one.
  const double inverse = (result.rising ? -1 : 1) / std::max(std::abs(per_layer), 1e-20);
  result.first = static_cast<float>(value.at(lattice.at(tile_.block.a, tile_.block.b, l)) * inverse);
  result.per_sample = static_cast<float>(value.gradient.dot(lattice.per_sample) * inverse);
  result.per_row = static_cast<float>(value.gradient.dot(lattice.per_row) * inverse);
  patch_kernels().lay_lanes(tile_.grid, result);
  return result;
}

// The mask keeps every tap of every foot in the box.
bool BandPainter::all_taps_kept(const FrameEntry& frame, const SampleBox& box) const {
  if (table_.mask_sums.empty()) return true;
  constexpr double room = 1e-3;  // px, beyond rounding
  const auto taps = [&](const AffineScalar& axis, int size) {
    const Span feet = span_of(axis, box);
    const auto pixel = [&](double at) {
      return static_cast<int>(std::clamp(std::floor(at), 0.0, size - 1.0));
    };
    return std::pair(pixel(feet.lowest - room), pixel(feet.highest + room + 1));
  };
  const auto [left, right] = taps(frame.x_px, frame.width);
  const auto [top, bottom] = taps(frame.y_px, frame.height);
  return table_.mask_sums.kept(left, top, right, bottom) ==
         static_cast<std::uint32_t>(right - left + 1) * static_cast<std::uint32_t>(bottom - top + 1);
}

void BandPainter::lay_out(const Lattice& lattice, const Chain& chain,
                          const std::vector<Candidate>& candidates, const SampleBox& box, int l,
                          Cells& cells) const {
  cells.members.clear();
  cells.frames.clear();
  cells.distances.clear();
  cells.shares.clear();
  cells.grey_taps = linear_ && table_.kind == PixelKind::grey;
  cells.boundaries.clear();
  const std::size_t members = chain.members.size();
  const auto entry = [&](std::size_t m) -> const FrameEntry& {
    return table_.frames[candidates[chain.members[m]].frame];
  };
  const auto z = [&](std::size_t m) { return oriented_z(entry(m)); };
  const auto reach = [&](std::size_t m) { return entry(m).gap_mm + tie_mm + float_tie_mm; };
  for (const int m : chain.members) {
    const int place = tile_.index_of(candidates[m].frame);
    const TileFrame& t = tile_.frames[place];
    cells.members.push_back(place);
    ChainFrame frame = t.at;
    frame.frame = &t.patch;
    frame.x += l * frame.x_per_layer;
    frame.y += l * frame.y_per_layer;
    cells.frames.push_back(frame);
  }
  const auto distance = [&](const AffineScalar& mm) -> TileDistance {
    return {static_cast<float>(mm.at(lattice.at(tile_.block.a, tile_.block.b, l))),
            static_cast<float>(mm.gradient.dot(lattice.per_sample)),
            static_cast<float>(mm.gradient.dot(lattice.per_row)),
            static_cast<float>(mm.gradient.dot(lattice.per_layer))};
  };
  ChainBoundary always, never;
  always.always = true;
  never.never = true;
  // First begins where the first frame reaches, z >= -d; the last ends where z > d.
  cells.boundaries.push_back(chain.first_ends ? boundary(lattice, plus(z(0), reach(0)), l) : always);
  for (std::size_t m = 0; m < members; ++m) {
    if (linear_) {
      const AffineScalar mm = z(m);
      cells.boundaries.push_back(boundary(lattice, mm, l));
      cells.distances.push_back(distance(mm));
      cells.grey_taps = cells.grey_taps && all_taps_kept(entry(m), box);
      if (m == 0) continue;
      const AffineScalar before = z(m - 1);
      ChainShare& share = cells.shares.emplace_back();
      share.z = distance(before);
      share.gap = distance({before.gradient - mm.gradient, before.offset - mm.offset});
      patch_kernels().lay_share(tile_.grid, share);
    } else if (m > 0) {
      const AffineScalar before = z(m - 1), after = z(m);
      const bool later = cells.members[m] > cells.members[m - 1];
      cells.boundaries.push_back(
          boundary(lattice,
                   {before.gradient + after.gradient,
                    before.offset + after.offset + (later ? float_tie_mm : -float_tie_mm)},
                   l));
    }
  }
  cells.boundaries.push_back(chain.last_ends ? boundary(lattice, plus(z(members - 1), -reach(members - 1)), l)
                                             : never);
}

int BandPainter::paint_cells(const Cells& cells, const PatchSite& site) {
  const int count = static_cast<int>(cells.boundaries.size()) - 1;
  if (!linear_) {
    return patch_kernels().take_chain(cells.frames.data(), cells.boundaries.data(), count, site, rule_,
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
      std::fill_n(layers_->has_data_row(l, y) + block.a, block.width, std::uint8_t{0});
    }
  }
}

// As paint_cells; layers kept apart one at a time, the first of the piece being `first_layer`.
int BandPainter::paint_layers(const Cells& cells, PatchSite site, int first_layer) {
  if (!apart()) return paint_cells(cells, site);
  const int layers = site.depth, a = tile_.block.a + site.da, b = tile_.block.b + site.db;
  if (!linear_) {
    const std::uint8_t missing = rule_ == Rule::minimum ? 255 : 0;
    for (int l = 0; l < layers; ++l) apart_.values[l].fill(missing);
    std::fill_n(apart_.has_data.begin(), layers, LaneMask{0});
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

// masks from range.low on.
void BandPainter::blend_cell(const Cells& cells, int cell, const PatchSite& site, const LayerRange& range,
                             LaneMask* masks) {
  const int layers = range.high - range.low;
  const auto side = [&](int member, BlendSide& out) {
    out.frame = tile_.candidates[cells.members[member]].frame;
    const ChainFrame& frame = cells.frames[member];
    out.patch = frame.frame;
    FixedPx x = frame.x_at(site, range.low) + foot_from_position;
    FixedPx y = frame.y_at(site, range.low) + foot_from_position;
    const TileDistance& z = cells.distances[member];
    for (int i = 0; i < layers; ++i, x += frame.x_per_layer, y += frame.y_per_layer) {
      out.x[i] = x;
      out.y[i] = y;
      out.z[i] = z.at(site, range.low + i);
    }
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
    patch_kernels().blend(tile_.grid, a.side(), b->side(), masks, layers, rule_, totals_.piece());
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
  patch_kernels().blend(tile_.grid, mine, other, masks, layers, rule_, totals_.piece());
}

void BandPainter::blend_lane(const BlendSide& a, const BlendSide* b, int l, int lane) {
  const auto z = [&](const BlendSide& s) {
    return static_cast<double>(s.z[l]) + static_cast<double>(s.z_per_sample) * tile_.grid.a[lane] +
           static_cast<double>(s.z_per_row) * tile_.grid.b[lane];
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
                               const std::vector<const PatchFrame*>& frames, std::size_t a, int b,
                               const LayerRange& range) {
  const Winners::Share& of_a = winners_.share(a);
  int first = std::max(of_a.first, range.low), last = std::min(of_a.last, range.high);
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

// What each candidate gives to some layers of place_.
void BandPainter::paint_shares(const std::vector<Candidate>& candidates,
                               const std::vector<const PatchFrame*>& frames, const LayerRange& range) {
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Winners::Share& s = winners_.share(c);
    const int first = std::max(s.first, range.low), last = std::min(s.last, range.high);
    if (first >= last) continue;
    if (linear_) {
      for (int other = -1; other < static_cast<int>(candidates.size()); ++other)
        if (other != static_cast<int>(c)) blend_shares(candidates, frames, c, other, range);
    } else {
      patch_kernels().take(*frames[c], s.x.data() + first, s.y.data() + first, s.wins.data() + first,
                           last - first, rule_, totals_.piece());
    }
  }
}

// Any geometry, at place_.
void BandPainter::paint_place(const std::vector<Candidate>& candidates,
                              const std::vector<const PatchFrame*>& frames) {
  winners_.find(table_, candidates, frames, place_, tile_.grid, interpolation());
  paint_shares(candidates, frames, {0, place_.layers});
}

// A patch of a tile whose frames are no chain throughout.
void BandPainter::paint_block(const Lattice& lattice, const LatticeBlock& block,
                              const std::vector<int>& frames) {
  std::vector<Candidate> candidates;
  const SampleBox box = box_of(lattice, block);
  cull(table_, frames, box, interpolation(), candidates);
  if (candidates.empty()) {
    blank(block);
    return;
  }
  const LaneMask lanes = existing_lanes(tile_.shape, block.width, block.height);
  Chain chain;
  if (make_chain(table_, candidates, box, chain)) {
    lay_out(lattice, chain, candidates, box, block.l, cells_);
    paint_layers(cells_, {block.a - tile_.block.a, block.b - tile_.block.b, block.depth, lanes}, block.l);
    return;
  }
  if (candidates.size() > many_candidates && block.depth > 8) {
    LatticeBlock half = block;
    half.depth = block.depth / 2;
    paint_block(lattice, half, frames);
    half.l += half.depth;
    half.depth = block.depth - half.depth;
    paint_block(lattice, half, frames);
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
  winners_.find(table_, candidates, patch_frames, place_, tile_.grid, interpolation());
  for (int l = 0; l < block.depth; ++l) {
    totals_.clear();
    paint_shares(candidates, patch_frames, {l, l + 1});
    store_layer(block.l + l, block.a, block.b);
  }
}

// Paints patch after patch where the frames are a chain, and halves the region where they are not.
void BandPainter::paint_region(const Lattice& lattice, const LatticeBlock& region,
                               const std::vector<int>& frames) {
  if (stopped()) return;
  const LaneShape shape = tile_.shape;
  const bool whole = region.width == tile_.block.width && region.height == tile_.block.height;
  std::vector<Candidate> culled;
  const SampleBox box = whole ? tile_.box : box_of(lattice, region);
  if (!whole) cull(table_, frames, box, interpolation(), culled);
  const std::vector<Candidate>& candidates = whole ? tile_.candidates : culled;
  if (candidates.empty()) {
    blank(region);
    return;
  }
  const auto paint_patches = [&](auto paint) {
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
  };
  Chain chain;
  if (region.depth <= patch_layers && make_chain(table_, candidates, box, chain)) {
    lay_out(lattice, chain, candidates, box, 0, cells_);
    int start = 0;
    paint_patches([&](int a, int b, int width, int height) {
      start = paint_layers(
          cells_,
          {a - tile_.block.a, b - tile_.block.b, region.depth, existing_lanes(shape, width, height), start},
          0);
    });
    return;
  }
  std::vector<int> near;
  for (const Candidate& c : candidates) near.push_back(c.frame);
  const int across = (region.width + shape.across - 1) / shape.across;
  const int down = (region.height + shape.down() - 1) / shape.down();
  if (region.depth > patch_layers || across * down == 1) {
    paint_patches([&](int a, int b, int width, int height) {
      for (int l = 0; l < region.depth; l += patch_layers) {
        if (l > 0 && !apart()) totals_.next_piece();
        paint_block(lattice, {a, b, l, width, height, std::min(patch_layers, region.depth - l)}, near);
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
  paint_region(lattice, first, near);
  paint_region(lattice, second, near);
}

void BandPainter::paint_tiles(const Lattice& lattice, const std::vector<int>& frames, int a, int b,
                              int width) {
  const int height = std::min(tile_pixels, lattice.rows - b);
  std::vector<Candidate> candidates;
  cull(table_, frames, box_of(lattice, {a, b, 0, width, height, lattice.layers}), interpolation(),
       candidates);
  std::vector<int> near;
  for (const Candidate& c : candidates) near.push_back(c.frame);
  if (near.empty()) {
    blank({a, b, 0, width, height, lattice.layers});
    return;
  }
  bool opened = tile_.open(table_, lattice, near, interpolation(), a, b);
  for (const int end = a + width; a < end; a += tile_pixels) {
    if (stopped()) return;
    const bool more = a + tile_pixels < end;
    const bool next_opened =
        more && next_tile_.open(table_, lattice, near, interpolation(), a + tile_pixels, b);
    if (opened) {
      paint_region(lattice, tile_.block, near);
    } else {
      blank({a, b, 0, std::min(tile_pixels, end - a), height, lattice.layers});
    }
    std::swap(tile_, next_tile_);
    opened = next_opened;
  }
}

void BandPainter::paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first,
                              int last) {
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
    totals_.store(*image_, a, row, tile_.shape);
  }
}

}  // namespace sonoband
