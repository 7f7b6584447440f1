#include "core/reslice/ruling_painter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

constexpr LaneShape shape{patch_lanes / rulings_together};
// The general painter's blocks: below so many samples nothing is gained by halving.
constexpr int least_samples = patch_lanes;
constexpr int samples_in_turn = 256;

}  // namespace

void RulingPainter::paint(const std::vector<int>& frames, int first) {
  struct Block {
    int first, last;
    std::vector<int> near;
  };
  std::vector<Block> blocks;
  std::vector<Candidate> candidates;
  const int end = std::min(first + rulings_in_turn, bundle_.rows);
  for (int row = first; row < end; row += rulings_together) {
    Block block{row, std::min(row + rulings_together, end), {}};
    const BlockBox box = box_of(bundle_, {block.first, block.last, 0, bundle_.samples});
    if (box.empty) continue;
    cull(table_, frames, box.box, interpolation(), candidates);
    for (const Candidate& c : candidates) block.near.push_back(c.frame);
    blocks.push_back(std::move(block));
  }
  // Lines beside one another take the same pixels: they come while the cache has them.
  for (int a = 0; a < bundle_.samples; a += samples_in_turn)
    for (const Block& block : blocks)
      paint_region({block.first, block.last, a, std::min(a + samples_in_turn, bundle_.samples)}, block.near);
}

void RulingPainter::paint_region(const Region& region, const std::vector<int>& frames) {
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) return;
  const BlockBox block = box_of(bundle_, {region.first, region.last, region.a, region.end});
  if (block.empty) return;
  std::vector<Candidate> candidates;
  cull(table_, frames, block.box, interpolation(), candidates);
  if (candidates.empty()) return;
  const int samples = region.end - region.a;
  Chain chain;
  if (nearest_ && bundle_.layers <= patch_layers && make_chain(table_, candidates, block.box, chain)) {
    paint_chain(region, chain, candidates);
    return;
  }
  std::vector<int> near;
  for (const Candidate& c : candidates) near.push_back(c.frame);
  if (samples <= least_samples) {
    general_.paint_lines(bundle_, near, region.a, region.first, region.last);
    return;
  }
  Region half = region;
  half.end = region.a + (samples / 2 + least_samples - 1) / least_samples * least_samples;
  paint_region(half, near);
  half.a = half.end;
  half.end = region.end;
  paint_region(half, near);
}

void RulingPainter::find_lines(const Region& region) {
  lines_.assign(bundle_.layers, 0);
  for (int row = region.first; row < region.last; ++row)
    for (int l = 0; l < bundle_.layers; ++l)
      if (present(row, l)) lines_[l] = static_cast<std::uint8_t>(lines_[l] | 1 << (row - region.first));
}

// Distances at the region's first sample, by layer and line; 0 for lines that are absent.
void RulingPainter::distances(const Region& region, const AffineScalar& z,
                              std::vector<RuledValues>& out) const {
  out.assign(bundle_.layers, RuledValues{});
  const double first = region.a * z.gradient.dot(bundle_.step.v) + z.offset;
  for (int row = region.first; row < region.last; ++row) {
    const int r = row - region.first;
    const auto* starts = bundle_.starts.data() + static_cast<std::size_t>(row) * bundle_.layers;
    for (int l = 0; l < bundle_.layers; ++l)
      if ((lines_[l] >> r & 1) != 0) out[l].of[r] = z.gradient.dot(starts[l].v) + first;
  }
}

// Of the condition before + after + offset >= 0.
RulingPainter::Boundary RulingPainter::boundary(const Region& region, const std::vector<RuledValues>& before,
                                                const std::vector<RuledValues>* after, double per_sample,
                                                double offset) const {
  Boundary result;
  result.rising = per_sample >= 0;
  result.layers.resize(bundle_.layers);
  patch_kernels().find_changes({before.data(), after != nullptr ? after->data() : nullptr, per_sample, offset,
                                region.end - region.a, bundle_.layers},
                               result.layers.data());
  return result;
}

RulingPainter::Boundary RulingPainter::constant(bool holds) const {
  const auto all = static_cast<std::uint8_t>(holds ? 255 : 0);
  return {true, std::vector<RulingChange>(bundle_.layers, {{}, all, static_cast<std::uint8_t>(~all)})};
}

// Appends what a cell takes of a layer, if anything.
void RulingPainter::add_layer(const Region& region, const FrameEntry& frame, const Boundary& from,
                              const Boundary& to, int layer) {
  const RulingChange& begin = from.layers[layer];
  const RulingChange& end = to.layers[layer];
  const unsigned lines = lines_[layer] & ~unsigned{begin.nowhere} & ~unsigned{end.everywhere};
  if (lines == 0) return;
  RulingLayer entry;
  entry.layer = layer;
  entry.from = (lines & ~unsigned{begin.everywhere}) == 0 ? nullptr : begin.at.data();
  entry.to = (lines & ~unsigned{end.nowhere}) == 0 ? nullptr : end.at.data();
  entry.feet = static_cast<int>(feet_.size());
  entry.least_x = entry.least_y = std::numeric_limits<FixedPx>::max();
  entry.greatest_x = entry.greatest_y = std::numeric_limits<FixedPx>::min();
  Feet feet{};
  const double sample_x = region.a * frame.x_px.gradient.dot(bundle_.step.v) + frame.x_px.offset;
  const double sample_y = region.a * frame.y_px.gradient.dot(bundle_.step.v) + frame.y_px.offset;
  for (unsigned rest = lines; rest != 0; rest &= rest - 1) {
    const int r = std::countr_zero(rest);
    const Eigen::Vector3d& start =
        bundle_.starts[static_cast<std::size_t>(region.first + r) * bundle_.layers + layer].v;
    const FixedPx x = fixed_position(frame.x_px.gradient.dot(start) + sample_x);
    const FixedPx y = fixed_position(frame.y_px.gradient.dot(start) + sample_y);
    feet.x[r] = x;
    feet.y[r] = y;
    entry.lanes |= LaneMask{0xff} << (8 * r);
    entry.least_x = std::min(entry.least_x, x);
    entry.greatest_x = std::max(entry.greatest_x, x);
    entry.least_y = std::min(entry.least_y, y);
    entry.greatest_y = std::max(entry.greatest_y, y);
  }
  feet_.push_back(feet);
  layers_.push_back(entry);
}

void RulingPainter::paint_chain(const Region& region, const Chain& chain,
                                const std::vector<Candidate>& candidates) {
  const std::size_t members = chain.members.size();
  const auto entry = [&](std::size_t m) -> const FrameEntry& {
    return table_.frames[candidates[chain.members[m]].frame];
  };
  const auto reach = [&](std::size_t m) { return entry(m).gap_mm + tie_mm; };
  const auto per_sample = [&](std::size_t m) { return oriented_z(entry(m)).gradient.dot(bundle_.step.v); };
  feet_.clear();
  layers_.clear();
  cells_.clear();
  patches_.resize(std::max(patches_.size(), members));
  const LaneGrid grid = lane_grid(shape);
  find_lines(region);
  std::vector<RuledValues> z, next_z;
  distances(region, oriented_z(entry(0)), z);
  std::vector<Boundary> boundaries(members + 1);
  // As BandPainter::lay_out.
  boundaries[0] = chain.first_ends ? boundary(region, z, nullptr, per_sample(0), reach(0)) : constant(true);
  for (std::size_t m = 0; m < members; ++m) {
    if (m + 1 < members) {
      distances(region, oriented_z(entry(m + 1)), next_z);
      const bool later = chain.members[m + 1] > chain.members[m];
      boundaries[m + 1] =
          boundary(region, z, &next_z, per_sample(m) + per_sample(m + 1), later ? tie_mm : -tie_mm);
    } else {
      boundaries[m + 1] =
          chain.last_ends ? boundary(region, z, nullptr, per_sample(m), -reach(m)) : constant(false);
    }
    std::swap(z, next_z);
    const FrameEntry& f = entry(m);
    RulingCell cell;
    cell.first = static_cast<int>(layers_.size());
    for (int l = 0; l < bundle_.layers; ++l) add_layer(region, f, boundaries[m], boundaries[m + 1], l);
    cell.last = static_cast<int>(layers_.size());
    if (cell.first == cell.last) continue;
    const FootSteps steps{f.x_px.gradient.dot(bundle_.step.v), 0, f.y_px.gradient.dot(bundle_.step.v), 0};
    make_patch_frame(f, steps, grid, 1, patches_[m]);
    cell.frame = &patches_[m];
    cell.x_per_sample = std::llround(steps.x_per_sample * fixed_per_px);
    cell.y_per_sample = std::llround(steps.y_per_sample * fixed_per_px);
    cell.from_rising = boundaries[m].rising;
    cell.to_rising = boundaries[m + 1].rising;
    cells_.push_back(cell);
  }
  for (RulingLayer& layer : layers_) {
    layer.x = feet_[layer.feet].x.data();
    layer.y = feet_[layer.feet].y.data();
  }
  for (int a = region.a; a < region.end; a += shape.across) {
    totals_.clear();
    const LaneMask lanes = existing_lanes(shape, region.end - a, region.last - region.first);
    patch_kernels().take_rulings(cells_.data(), static_cast<int>(cells_.size()), layers_.data(), a - region.a,
                                 lanes, rule_, totals_.piece());
    totals_.store(image_, a, region.first, shape);
  }
}

}  // namespace sonoband
