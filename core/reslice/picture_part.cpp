#include "core/reslice/picture_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Kernels load up to so many pixels from a row's last on.
constexpr int load_px = 128;
// Of distances in 32-bit floats, by which kernels choose, and of ties.
constexpr double reach_room_mm = 1e-3;

}  // namespace

PicturePart part_within(double reach_mm, const FrameEntry& frame, const Candidate& candidate,
                        const Lattice& lattice, const LatticeBlock& tile, const ChainFrame& at) {
  // The range of each axis in which the frame is within reach at all.
  const AffineScalar z = oriented_z(frame);
  const std::array<double, 3> per = {z.gradient.dot(lattice.per_sample), z.gradient.dot(lattice.per_row),
                                     z.gradient.dot(lattice.per_layer)};
  const std::array<int, 3> size = {tile.width - 1, tile.height - 1, tile.depth - 1};
  const double half_range = (candidate.z.highest - candidate.z.lowest) / 2;
  std::array<double, 3> low{}, high{};
  for (int i = 0; i < 3; ++i) {
    low[i] = 0;
    high[i] = size[i];
    if (std::abs(per[i]) < 1e-6) continue;
    const double others = half_range - std::abs(per[i]) * size[i] / 2 + reach_mm;
    const double centre = size[i] / 2.0 - candidate.z_centre / per[i], width = others / std::abs(per[i]);
    low[i] = std::clamp(centre - width, 0.0, static_cast<double>(size[i]));
    high[i] = std::clamp(centre + width, low[i], static_cast<double>(size[i]));
  }
  const auto range = [&](FixedPx from, FixedPx a, FixedPx b, FixedPx l) {
    const std::array<FixedPx, 3> steps = {a, b, l};
    double least = static_cast<double>(from), greatest = least;
    for (int i = 0; i < 3; ++i) {
      const double first = static_cast<double>(steps[i]) * low[i],
                   last = static_cast<double>(steps[i]) * high[i];
      least += std::min(first, last);
      greatest += std::max(first, last);
    }
    return std::pair(least / fixed_per_px, greatest / fixed_per_px);
  };
  const auto [left, right] = range(at.x, at.x_per_sample, at.x_per_row, at.x_per_layer);
  const auto [top, bottom] = range(at.y, at.y_per_sample, at.y_per_row, at.y_per_layer);
  // A position's whole part is the pixel; taps begin half a pixel before it. And one for rounding.
  const auto first = [](double position) { return static_cast<int>(std::floor(position)) - 2; };
  const auto last = [](double position) { return static_cast<int>(std::floor(position)) + 2; };
  return {first(left), last(right), first(top), last(bottom)};
}

RowsAhead rows_ahead(const FrameEntry& frame, const PicturePart& part) {
  const int left = std::clamp(part.left + 2, 0, frame.width - 1);
  const int right = std::clamp(part.right - 2, 0, frame.width - 1);
  const int top = std::clamp(part.top + 2, 0, frame.height - 1);
  const int bottom = std::clamp(part.bottom - 2, 0, frame.height - 1);
  return {frame.pixels + top * frame.stride + left, frame.stride, right - left + 1, bottom - top + 1};
}

std::vector<double> chain_reaches(const FrameTable& table, const std::vector<Candidate>& candidates,
                                  const Chain& chain, const SampleBox& box, Interpolation interpolation) {
  const double part = interpolation == Interpolation::linear && !chain.unblended ? 1 : 0.5;
  std::vector<double> reaches(candidates.size());
  const std::vector<int>& members = chain.members;
  const auto z = [&](std::size_t m) { return oriented_z(table.frames[candidates[members[m]].frame]); };
  for (std::size_t m = 0; m + 1 < members.size(); ++m) {
    const AffineScalar a = z(m), b = z(m + 1);
    const double reach = part * span_of({a.gradient - b.gradient, a.offset - b.offset}, box).highest;
    for (const std::size_t side : {m, m + 1})
      reaches[members[side]] = std::max(reaches[members[side]], reach);
  }
  for (const int end : {members.front(), members.back()})
    reaches[end] = std::max(reaches[end], table.frames[candidates[end].frame].gap_mm + tie_mm);
  for (double& reach : reaches) reach += reach_room_mm;
  return reaches;
}

void turn_positions(ChainFrame& at) {
  std::swap(at.x, at.y);
  std::swap(at.x_per_sample, at.y_per_sample);
  std::swap(at.x_per_row, at.y_per_row);
  std::swap(at.x_per_layer, at.y_per_layer);
}

void TurnedParts::clear() {
  parts_.clear();
  size_ = 0;
}

void TurnedParts::add(const FrameEntry& frame, const PicturePart& part, ChainFrame& at) {
  const std::ptrdiff_t stride = (part.rows() + 15) / 16 * 16;
  parts_.push_back({&frame, part, size_, stride});
  size_ += static_cast<std::size_t>(part.columns()) * stride + load_px;
  turn_positions(at);
  at.x -= static_cast<FixedPx>(part.top) << 32;
  at.y -= static_cast<FixedPx>(part.left) << 32;
}

FrameEntry TurnedParts::picture(std::size_t i) const {
  const Part& p = parts_[i];
  FrameEntry turned;
  turned.pixels = pixels_.data() + p.first;
  turned.stride = p.stride;
  // Its edges are no picture's: what is loaded beyond a row is never taken.
  turned.width = static_cast<int>(p.stride) + load_px;
  turned.height = p.part.columns();
  return turned;
}

void TurnedParts::bound(std::size_t i, PatchFrame& patch) const {
  const Part& p = parts_[i];
  patch.first_x = -p.part.top;
  patch.last_x = p.frame->height - 1 - p.part.top;
  patch.first_y = -p.part.left;
  patch.last_y = p.frame->width - 1 - p.part.left;
}

void TurnedParts::turn() {
  for (const Part& p : parts_) {
    patch_kernels().turn({p.frame->pixels, p.frame->stride, p.frame->width, p.frame->height}, p.part.left,
                         p.part.top, p.part.columns(), p.part.rows(), pixels_.data() + p.first, p.stride);
  }
}

}  // namespace sonoband
