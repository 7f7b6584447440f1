#include "core/reslice/chain_ends.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/reslice/chain_walk.h"
#include "core/reslice/patch_kernels.h"

namespace sonoband {
namespace {

// Of distances in 32-bit floats: so close is equal.
constexpr float float_tie_mm = 1e-5F;

// Least and greatest of an affine function over a grid's lanes, or beyond them.
struct LaneExtremes {
  float least, greatest;
  LaneExtremes(const LaneGrid& grid, float per_sample, float per_row) {
    const auto [a, b] = std::minmax(
        {per_sample * static_cast<float>(grid.least_a), per_sample * static_cast<float>(grid.greatest_a)});
    const auto [c, d] = std::minmax(
        {per_row * static_cast<float>(grid.least_b), per_row * static_cast<float>(grid.greatest_b)});
    least = a + c;
    greatest = b + d;
  }
};

// Layers first .. last - 1 of a patch in which a lane may be within `reach_mm`.
LayerRange layers_within(float reach_mm, const TileDistance& z, const LaneGrid& grid, const PatchSite& site) {
  const LaneExtremes lanes(grid, z.per_sample, z.per_row);
  const float at = z.at(site, 0), low = at + lanes.least - reach_mm, high = at + lanes.greatest + reach_mm;
  // low + l per_layer <= 0 <= high + l per_layer
  if (std::abs(z.per_layer) < 1e-6F) {
    constexpr float room_mm = 1e-6F * patch_layers;
    return low > room_mm || high < -room_mm ? LayerRange{} : LayerRange{site.first, site.depth};
  }
  const auto [from, to] = std::minmax({-low / z.per_layer, -high / z.per_layer});
  constexpr float far = 1000;  // a patch has fewer layers
  return {std::max(site.first, static_cast<int>(std::floor(std::clamp(from, -far, far)))),
          std::min(site.depth, static_cast<int>(std::ceil(std::clamp(to, -far, far))) + 1)};
}

// False where no lane at positions between these has a pixel of the picture.
bool may_hold(const PatchFrame& f, FixedPx x, FixedPx last_x, FixedPx y, FixedPx last_y) {
  const auto pixel = [](FixedPx at) { return static_cast<int>(at >> 32); };
  return pixel(std::max(x, last_x)) + f.least_column + f.columns + 1 >= f.first_x &&
         pixel(std::min(x, last_x)) + f.least_column <= f.last_x &&
         pixel(std::max(y, last_y)) + f.least_row + f.rows + 1 >= f.first_y &&
         pixel(std::min(y, last_y)) + f.least_row <= f.last_y;
}

}  // namespace

void ChainEnds::claim(const ChainCells& cells, const LaneGrid& grid, const PatchSite& site, int member) {
  const TileDistance& z = cells.distances[member];
  const float reach = cells.reaches[member];
  LayerRange range = layers_within(reach, z, grid, site);
  while (range.low < range.high && without_[range.low] == 0) ++range.low;
  while (range.low < range.high && without_[range.high - 1] == 0) --range.high;
  if (range.low >= range.high) return;
  const ChainFrame& f = cells.frames[member];
  FixedPx x = f.x_at(site, range.low), y = f.y_at(site, range.low);
  const int layers = range.high - range.low;
  if (!may_hold(*f.frame, x, x + (layers - 1) * f.x_per_layer, y, y + (layers - 1) * f.y_per_layer)) return;
  if (share_count_ == shares_.size()) shares_.emplace_back();
  Share& share = shares_[share_count_];
  share.member = member;
  share.first = range.low;
  share.last = range.high;
  for (int i = 0; i < layers; ++i, x += f.x_per_layer, y += f.y_per_layer) {
    share.lanes[i] = without_[range.low + i];
    share.x[i] = x;
    share.y[i] = y;
  }
  patch_kernels().inside(*f.frame, share.x.data(), share.y.data(), layers, share.lanes.data());
  LaneMask taken = 0;
  for (int i = 0; i < layers; ++i) {
    const int l = range.low + i;
    const float at = z.at(site, l);
    for (LaneMask rest = share.lanes[i]; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      const LaneMask bit = LaneMask{1} << lane;
      const float mm = std::abs(at + (z.per_sample * grid.a[lane] + z.per_row * grid.b[lane]));
      const bool given = (given_[l] & bit) != 0;
      if (mm > reach || (given && mm > nearest_mm_[l][lane] + float_tie_mm)) {
        share.lanes[i] &= ~bit;
        continue;
      }
      if (given) {
        Share& other = shares_[share_of_[l][lane]];
        other.lanes[l - other.first] &= ~bit;
      }
      given_[l] |= bit;
      nearest_mm_[l][lane] = mm;
      share_of_[l][lane] = static_cast<std::uint16_t>(share_count_);
    }
    taken |= share.lanes[i];
  }
  // Most frames end where the nearest does.
  if (taken != 0) ++share_count_;
}

void ChainEnds::hand_over(const ChainCells& cells, const LaneGrid& grid, const PatchSite& site, Rule rule,
                          PatchSums& sums) {
  LaneMask any = 0;
  for (int l = site.first; l < site.depth; ++l) any |= without_[l];
  if (any == 0) return;
  given_.fill(0);
  share_count_ = 0;
  for (const int member : cells.by_capture) claim(cells, grid, site, member);
  for (std::size_t i = 0; i < share_count_; ++i) {
    const Share& share = shares_[i];
    patch_kernels().take(*cells.frames[share.member].frame, share.x.data(), share.y.data(),
                         share.lanes.data(), share.last - share.first, rule, sums);
  }
}

}  // namespace sonoband
