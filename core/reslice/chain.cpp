#include "core/reslice/chain.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/reslice/thinning.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Distances this close are the general algebra's business.
constexpr double apart_mm = 1e-4;

Span gap_between(const FrameTable& table, const Candidate& before, const Candidate& after,
                 const SampleBox& box) {
  const AffineScalar a = oriented_z(table.frames[before.frame]), b = oriented_z(table.frames[after.frame]);
  return span_of({a.gradient - b.gradient, a.offset - b.offset}, box);
}

bool whole(std::span<const Candidate> candidates) {
  return std::all_of(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.full; });
}

// All that make_chain asks for but that the pictures hold every foot.
bool follow_one_another(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                        Chain& chain) {
  chain.unblended = false;
  chain.members.resize(candidates.size());
  std::iota(chain.members.begin(), chain.members.end(), 0);
  // A sweep goes one way but for its turns.
  if (candidates.front().z_centre < candidates.back().z_centre)
    std::reverse(chain.members.begin(), chain.members.end());
  const auto farther = [&](int a, int b) { return candidates[a].z_centre > candidates[b].z_centre; };
  if (!std::is_sorted(chain.members.begin(), chain.members.end(), farther))
    std::sort(chain.members.begin(), chain.members.end(), farther);
  const auto member = [&](std::size_t i) -> const Candidate& { return candidates[chain.members[i]]; };
  const auto reach = [&](const Candidate& c) { return table.frames[c.frame].gap_mm; };
  double greatest_reach = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    greatest_reach = std::max(greatest_reach, reach(member(i)));
    if (i == 0) continue;
    const Span gap = gap_between(table, member(i - 1), member(i), box);
    if (gap.lowest <= apart_mm || gap.highest > 2 * std::min(reach(member(i - 1)), reach(member(i))))
      return false;
  }
  const Candidate& first = member(0);
  const Candidate& last = member(candidates.size() - 1);
  chain.first_ends = first.z.lowest < 0;
  chain.last_ends = last.z.highest > 0;
  // Where an end frame is out of reach, one behind it could reach only by being longer in reach than it is
  // behind.
  const auto outreached = [&](const Candidate& end) {
    if (greatest_reach <= reach(end)) return false;
    for (const Candidate& c : candidates) {
      if (c.frame == end.frame) continue;
      const Span behind = gap_between(table, end, c, box);
      const double least = behind.lowest > 0 ? behind.lowest : -behind.highest;
      if (reach(c) > reach(end) + least - apart_mm) return true;
    }
    return false;
  };
  return !(chain.first_ends && outreached(first)) && !(chain.last_ends && outreached(last));
}

}  // namespace

bool make_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                Chain& chain) {
  chain.whole = true;
  return !candidates.empty() && whole(candidates) && follow_one_another(table, candidates, box, chain);
}

bool make_ending_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                       Chain& chain) {
  chain.whole = whole(candidates);
  return !candidates.empty() && follow_one_another(table, candidates, box, chain);
}

double OutputPixel::along(const Eigen::Vector3d& normal) const {
  const double most = (axes * normal).cwiseAbs().maxCoeff();
  return thinning_pixel * (most > 0 ? mm / most : mm);
}

void thin_chain(const FrameTable& table, std::span<const Candidate> candidates, const SampleBox& box,
                const OutputPixel& pixel, Interpolation interpolation, Chain& chain) {
  const std::vector<int>& all = chain.members;
  const auto entry = [&](std::size_t i) -> const FrameEntry& {
    return table.frames[candidates[all[i]].frame];
  };
  std::vector<double> pixels;  // across the members
  for (std::size_t i = 0; i < all.size(); ++i) pixels.push_back(pixel.along(entry(i).normal));
  // From member i to member j, behind it, they are at most a pixel apart.
  const auto near = [&](std::size_t i, std::size_t j) {
    const FrameEntry &a = entry(i), &b = entry(j);
    const double most_mm = std::min(pixels[i], pixels[j]);
    const AffineScalar from = oriented_z(a), to = oriented_z(b);
    // By which their gap changes in a mm.
    const double turn = (a.normal - (a.flipped == b.flipped ? 1 : -1) * b.normal).norm();
    return span_of({from.gradient - to.gradient, from.offset - to.offset}, box).highest +
               turn * most_mm / 2 <=
           most_mm;
  };
  const auto neighbours = [&](std::size_t i, std::size_t j) {
    if (interpolation == Interpolation::linear || !table.complete) return near(i, j);
    return near(i, j - 1) && near(i + 1, j);
  };
  std::vector<int> kept = {all.front()};
  std::vector<std::size_t> place = {0};  // of those kept in `all`
  for (std::size_t i = 0; i + 1 < all.size();) {
    std::size_t j = i + 1;
    while (j + 1 < all.size() && neighbours(i, j + 1)) ++j;
    kept.push_back(all[j]);
    place.push_back(j);
    i = j;
  }
  chain.unblended = interpolation == Interpolation::linear;
  for (std::size_t k = 1; k < kept.size() && chain.unblended; ++k) {
    chain.unblended = near(place[k - 1], place[k]);
  }
  chain.members = std::move(kept);
}

}  // namespace sonoband
