#include "core/reslice/winners.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Room for the rounding of 32-bit floats, a hundredth of a micrometre: ties go the written way.
constexpr double float_tie_mm = 1e-5;

// What an affine function adds from lane 0 to any lane.
struct LaneSpan {
  double lowest, highest;
};
LaneSpan lane_span(double per_sample, double per_row, LaneShape shape) {
  const double along = per_sample * (shape.across - 1), down = per_row * (shape.down() - 1);
  return {std::min(along, 0.0) + std::min(down, 0.0), std::max(along, 0.0) + std::max(down, 0.0)};
}

// A function over the layers of a contest: its lanes where it is >= a limit, and its sign where it has only
// one.
struct Side {
  std::array<double, patch_layers> base;
  double per_sample = 0, per_row = 0;
  int sign = 0;

  void settle(int layers, LaneShape shape) {
    const auto [low, high] = std::minmax_element(base.begin(), base.begin() + layers);
    const LaneSpan lanes = lane_span(per_sample, per_row, shape);
    sign = *low + lanes.lowest > float_tie_mm ? 1 : *high + lanes.highest < -float_tie_mm ? -1 : 0;
  }
  // masks[l] = lanes with value >= limit
  void at_least(double limit, int layers, const LaneGrid& grid, LaneMask* masks) const {
    std::array<float, patch_layers> above;
    for (int l = 0; l < layers; ++l) above[l] = static_cast<float>(base[l] - limit);
    patch_kernels().half_space(grid, above.data(), static_cast<float>(per_sample),
                               static_cast<float>(per_row), layers, masks);
  }
};

}  // namespace

void values_at(const PatchPlace& place, const AffineScalar& f, double* values) {
  const double gx = f.gradient.x(), gy = f.gradient.y(), gz = f.gradient.z();
  for (int l = 0; l < place.layers; ++l)
    values[l] = gx * place.x[l] + gy * place.y[l] + gz * place.z[l] + f.offset;
}

void Winners::find(const FrameTable& table, std::span<const Candidate> candidates,
                   std::span<const PatchFrame* const> frames, const PatchPlace& place, const LaneGrid& grid,
                   Interpolation interpolation) {
  linear_ = interpolation == Interpolation::linear;
  shape_ = place.shape;
  if (shares_.size() < candidates.size()) shares_.resize(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c)
    support(table, candidates[c], *frames[c], place, grid, shares_[c]);
  meetings_.clear();
  for (std::size_t later = 1; later < candidates.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      if (!may_meet(shares_[earlier], shares_[later])) continue;
      meetings_.push_back({earlier, later});
      contest(shares_[earlier], shares_[later], place, grid);
    }
  }
  if (!linear_) return;
  std::fill_n(positive_.begin(), place.layers, LaneMask{0});
  std::fill_n(negative_.begin(), place.layers, LaneMask{0});
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Share& s = shares_[c];
    for (int l = s.first; l < s.last; ++l) {
      positive_[l] |= s.side_wins[l] & s.positive[l];
      negative_[l] |= s.side_wins[l] & ~s.positive[l];
    }
  }
}

bool Winners::may_meet(const Share& a, const Share& b) const {
  const int first = std::max(a.first, b.first), last = std::min(a.last, b.last);
  if (first >= last) return false;
  // Affine over the layers.
  const auto [low, high] = std::minmax({a.z[first] - b.z[first], a.z[last - 1] - b.z[last - 1]});
  const LaneSpan lanes = lane_span(a.z_per_sample - b.z_per_sample, a.z_per_row - b.z_per_row, shape_);
  const double both = a.reach_mm + b.reach_mm + 4 * float_tie_mm;
  return low + lanes.lowest <= both && high + lanes.highest >= -both;
}

void Winners::support(const FrameTable& table, const Candidate& candidate, const PatchFrame& frame,
                      const PatchPlace& place, const LaneGrid& grid, Share& share) {
  const FrameEntry& f = table.frames[candidate.frame];
  const AffineScalar z = oriented_z(f);
  values_at(place, z, share.z.data());
  share.z_per_sample = z.gradient.dot(place.sample_step);
  share.z_per_row = z.gradient.dot(place.row_step);
  const LaneSpan lanes = lane_span(share.z_per_sample, share.z_per_row, place.shape);
  const double near_reach = f.gap_mm + tie_mm, far_reach = (linear_ ? 2 : 1) * f.gap_mm + tie_mm;
  share.reach_mm = far_reach;
  const auto near = [&](int l) {
    return share.z[l] + lanes.lowest <= far_reach && share.z[l] + lanes.highest >= -far_reach;
  };
  share.first = 0;
  share.last = place.layers;
  while (share.first < share.last && !near(share.first)) ++share.first;
  while (share.last > share.first && !near(share.last - 1)) --share.last;
  const int layers = share.last - share.first;
  if (layers == 0) return;

  std::array<double, patch_layers> foot;
  values_at(place, f.x_px, foot.data());
  for (int l = share.first; l < share.last; ++l) share.x[l] = fixed_position(foot[l]);
  values_at(place, f.y_px, foot.data());
  for (int l = share.first; l < share.last; ++l) share.y[l] = fixed_position(foot[l]);

  Side side;
  side.per_sample = share.z_per_sample;
  side.per_row = share.z_per_row;
  std::copy_n(share.z.data() + share.first, layers, side.base.data());
  const auto [low, high] = std::minmax_element(side.base.begin(), side.base.begin() + layers);
  const double lowest = *low + lanes.lowest, highest = *high + lanes.highest;
  // |z| <= reach, as two half spaces.
  const auto keep_within = [&](double reach, LaneMask* kept) {
    std::array<LaneMask, patch_layers> masks;
    if (highest > reach) {
      side.at_least(reach + float_tie_mm, layers, grid, masks.data());
      for (int l = 0; l < layers; ++l) kept[l] &= ~masks[l];
    }
    if (lowest < -reach) {
      side.at_least(-reach - float_tie_mm, layers, grid, masks.data());
      for (int l = 0; l < layers; ++l) kept[l] &= masks[l];
    }
  };
  const auto of_layers = [&](std::array<LaneMask, patch_layers>& masks) {
    return masks.data() + share.first;
  };
  LaneMask* support = of_layers(share.support);
  std::copy_n(place.lanes.data() + share.first, layers, support);
  keep_within(far_reach, support);
  if (!candidate.full) {
    patch_kernels().inside(frame, share.x.data() + share.first, share.y.data() + share.first, layers,
                           support);
  }
  if (linear_) {
    std::copy_n(support, layers, of_layers(share.far_support));
    std::copy_n(support, layers, of_layers(share.side_wins));
    side.at_least(0, layers, grid, of_layers(share.positive));
    keep_within(near_reach, support);
  }
  std::copy_n(support, layers, of_layers(share.wins));
}

void Winners::contest(Share& earlier, Share& later, const PatchPlace& place, const LaneGrid& grid) {
  const int first = std::max(earlier.first, later.first), last = std::min(earlier.last, later.last);
  const int layers = last - first;
  if (layers <= 0) return;
  Side sum, difference;
  for (int l = 0; l < layers; ++l) {
    sum.base[l] = earlier.z[first + l] + later.z[first + l];
    difference.base[l] = earlier.z[first + l] - later.z[first + l];
  }
  sum.per_sample = earlier.z_per_sample + later.z_per_sample;
  sum.per_row = earlier.z_per_row + later.z_per_row;
  difference.per_sample = earlier.z_per_sample - later.z_per_sample;
  difference.per_row = earlier.z_per_row - later.z_per_row;
  sum.settle(layers, place.shape);
  difference.settle(layers, place.shape);

  // Where the earlier frame is nearer by more than a tie.
  std::array<LaneMask, patch_layers> nearer;
  const auto below = [&](const Side& side, LaneMask* masks) {  // value < -tie
    side.at_least(-float_tie_mm, layers, grid, masks);
    for (int l = 0; l < layers; ++l) masks[l] = ~masks[l];
  };
  const auto above = [&](const Side& side, LaneMask* masks) {
    side.at_least(float_tie_mm, layers, grid, masks);
  };
  if (sum.sign != 0 && difference.sign != 0) {
    nearer.fill(sum.sign != difference.sign ? ~LaneMask{0} : 0);
  } else if (sum.sign != 0 || difference.sign != 0) {
    const Side& changing = sum.sign != 0 ? difference : sum;
    if (sum.sign + difference.sign > 0) {
      below(changing, nearer.data());
    } else {
      above(changing, nearer.data());
    }
  } else {
    std::array<LaneMask, patch_layers> sum_above, sum_below, difference_above, difference_below;
    above(sum, sum_above.data());
    below(sum, sum_below.data());
    above(difference, difference_above.data());
    below(difference, difference_below.data());
    for (int l = 0; l < layers; ++l)
      nearer[l] = (sum_above[l] & difference_below[l]) | (sum_below[l] & difference_above[l]);
  }
  for (int l = 0; l < layers; ++l) {
    earlier.wins[first + l] &= nearer[l] | ~later.support[first + l];
    later.wins[first + l] &= ~nearer[l] | ~earlier.support[first + l];
  }
  if (!linear_) return;
  // On the positive side the smaller z is nearer, on the other the greater.
  std::array<LaneMask, patch_layers> smaller, greater;
  if (difference.sign != 0) {
    std::fill_n(smaller.begin(), layers, difference.sign < 0 ? ~LaneMask{0} : 0);
    std::fill_n(greater.begin(), layers, difference.sign > 0 ? ~LaneMask{0} : 0);
  } else {
    below(difference, smaller.data());
    above(difference, greater.data());
  }
  for (int l = 0; l < layers; ++l) {
    const LaneMask of_earlier = earlier.positive[first + l], of_later = later.positive[first + l];
    const LaneMask same_side = ~(of_earlier ^ of_later);
    const LaneMask earlier_nearer = (of_earlier & smaller[l]) | (~of_earlier & greater[l]);
    earlier.side_wins[first + l] &= earlier_nearer | ~(same_side & later.far_support[first + l]);
    later.side_wins[first + l] &= ~earlier_nearer | ~(same_side & earlier.far_support[first + l]);
  }
}

}  // namespace sonoband
