// The vector code of patches, compiled once for each instruction set and chosen at run time by Highway.
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/reslice/patch_kernels.cpp"
#include "core/reslice/patch_targets.h"
// Highway's headers come after what they are told.
#include <hwy/foreach_target.h>
// Highway's per-target headers come after foreach_target.h.
#include <hwy/highway.h>

#include "core/reslice/patch_chain_plain-inl.h"
#include "core/reslice/patch_kernels.h"
#include "core/reslice/patch_linear_plain-inl.h"
#include "core/reslice/patch_plain-inl.h"
#include "core/reslice/patch_rulings-inl.h"
#include "core/reslice/patch_turn-inl.h"
#if HWY_TARGET == HWY_AVX3_DL
#include "core/reslice/patch_chain_vbmi-inl.h"
#include "core/reslice/patch_group_vbmi-inl.h"
#include "core/reslice/patch_linear_chain_vbmi-inl.h"
#include "core/reslice/patch_linear_vbmi-inl.h"
#include "core/reslice/patch_vbmi-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Whole and fractional parts of a * per_sample + b * per_row apart keep products in 32 bits.
HWY_ATTR OffsetSpan lane_positions(const LaneGrid& grid, FixedPx per_sample, FixedPx per_row,
                                   std::int32_t* offsets) {
  const Floats d;
  const Ints ints;
  const auto high = [&](FixedPx step)
                        HWY_ATTR { return hn::Set(ints, static_cast<std::int32_t>(step >> 16)); };
  const auto low = [&](FixedPx step)
                       HWY_ATTR { return hn::Set(ints, static_cast<std::int32_t>(step & 0xffff)); };
  const auto high_a = high(per_sample), low_a = low(per_sample), high_b = high(per_row), low_b = low(per_row);
  auto least = hn::Zero(ints), greatest = hn::Zero(ints);  // lane 0 has offset 0
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    const auto a = hn::ConvertTo(ints, hn::Load(d, grid.a.data() + k));
    const auto b = hn::ConvertTo(ints, hn::Load(d, grid.b.data() + k));
    const auto carried = hn::ShiftRight<16>(hn::Add(hn::Mul(a, low_a), hn::Mul(b, low_b)));
    const auto at = hn::Add(hn::Add(hn::Mul(a, high_a), hn::Mul(b, high_b)), carried);
    hn::Store(at, ints, offsets + k);
    least = hn::Min(least, at);
    greatest = hn::Max(greatest, at);
  }
  return {hn::GetLane(hn::MinOfLanes(ints, least)), hn::GetLane(hn::MaxOfLanes(ints, greatest))};
}

HWY_ATTR void split_positions(const std::int32_t* offsets, int least, std::uint16_t* fractions,
                              std::uint8_t* wholes) {
  const Ints ints;
  const hn::Rebind<std::uint16_t, Ints> words;
  const hn::Rebind<std::uint8_t, Ints> bytes;
  const auto first = hn::Set(ints, least);
  const auto mask = hn::Set(ints, 0xffff);
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(ints)) {
    const auto at = hn::Load(ints, offsets + k);
    hn::StoreU(hn::DemoteTo(words, hn::And(at, mask)), words, fractions + k);
    const auto whole_part = hn::And(hn::Sub(hn::ShiftRight<16>(at), first), hn::Set(ints, 0xff));
    hn::StoreU(hn::DemoteTo(bytes, whole_part), bytes, wholes + k);
  }
}

HWY_ATTR void inside(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers, LaneMask* masks) {
#if HWY_TARGET == HWY_AVX3_DL
  if (f.fetch != Fetch::single) return inside_permuted(f, x, y, layers, masks);
#endif
  for (int l = 0; l < layers; ++l) masks[l] = inside_single(f, x[l], y[l], masks[l]);
}

// Whole parts of a * per_sample + b * per_row, cut off to 16 bits.
HWY_ATTR inline void lane_wholes(const LaneGrid& grid, const TileFixed& of, std::uint16_t* wholes) {
  alignas(64) std::int32_t offsets[patch_lanes];
  lane_positions(grid, of.per_sample, of.per_row, offsets);
  const Ints ints;
  const hn::Rebind<std::uint16_t, Ints> words;
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(ints)) {
    const auto whole_part = hn::And(hn::ShiftRight<16>(hn::Load(ints, offsets + k)), hn::Set(ints, 0xffff));
    hn::StoreU(hn::DemoteTo(words, whole_part), words, wholes + k);
  }
}

HWY_ATTR void lay_share(const LaneGrid& grid, ChainShare& share) {
  if (share.even) {
    lane_wholes(grid, share.part, share.part_lanes.data());
    lane_wholes(grid, share.bend, share.bend_lanes.data());
    return;
  }
  for (int k = 0; k < patch_lanes; ++k) {
    share.z_lanes[share_place(k)] = share.z.per_sample * grid.a[k] + share.z.per_row * grid.b[k];
    share.gap_lanes[share_place(k)] = share.gap.per_sample * grid.a[k] + share.gap.per_row * grid.b[k];
  }
}

HWY_ATTR void take(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks, int layers,
                   Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return take_by<Rule::maximum>(f, x, y, masks, layers, sums);
    case Rule::minimum:
      return take_by<Rule::minimum>(f, x, y, masks, layers, sums);
    case Rule::mean_grey:
      return take_by<Rule::mean_grey>(f, x, y, masks, layers, sums);
    case Rule::mean_doppler:
      return take_by<Rule::mean_doppler>(f, x, y, masks, layers, sums);
  }
}

HWY_ATTR int take_chain(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                        const PatchSite& site, Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return take_chain_by<Rule::maximum>(frames, boundaries, count, site, sums);
    case Rule::minimum:
      return take_chain_by<Rule::minimum>(frames, boundaries, count, site, sums);
    case Rule::mean_grey:
      return take_chain_by<Rule::mean_grey>(frames, boundaries, count, site, sums);
    case Rule::mean_doppler:
      break;
  }
  return take_chain_by<Rule::mean_doppler>(frames, boundaries, count, site, sums);
}

HWY_ATTR int take_chain_ends(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                             const PatchSite& site, Rule rule, PatchSums& sums, LaneMask* without) {
  switch (rule) {
    case Rule::maximum:
      return take_chain_ends_by<Rule::maximum>(frames, boundaries, count, site, sums, without);
    case Rule::minimum:
      return take_chain_ends_by<Rule::minimum>(frames, boundaries, count, site, sums, without);
    case Rule::mean_grey:
      return take_chain_ends_by<Rule::mean_grey>(frames, boundaries, count, site, sums, without);
    case Rule::mean_doppler:
      break;
  }
  return take_chain_ends_by<Rule::mean_doppler>(frames, boundaries, count, site, sums, without);
}

#if HWY_TARGET == HWY_AVX3_DL
HWY_ATTR int take_cell(const ChainFrame& frame, const ChainBoundary* boundaries, bool ends, Rule rule,
                       PatchGroup& group, std::uint8_t* at_edge) {
  switch (rule) {
    case Rule::maximum:
      return take_cell_by<Rule::maximum>(frame, boundaries, ends, group, at_edge);
    case Rule::minimum:
      return take_cell_by<Rule::minimum>(frame, boundaries, ends, group, at_edge);
    case Rule::mean_grey:
      return take_cell_by<Rule::mean_grey>(frame, boundaries, ends, group, at_edge);
    case Rule::mean_doppler:
      break;
  }
  return take_cell_by<Rule::mean_doppler>(frame, boundaries, ends, group, at_edge);
}
#else
constexpr auto take_cell = nullptr;
#endif

HWY_ATTR int blend_chain(const ChainFrame* frames, const ChainShare* shares, const ChainBoundary* boundaries,
                         int count, const PatchSite& site, Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return blend_chain_by<Rule::maximum>(frames, shares, boundaries, count, site, sums);
    case Rule::minimum:
      return blend_chain_by<Rule::minimum>(frames, shares, boundaries, count, site, sums);
    case Rule::mean_grey:
    case Rule::mean_doppler:
      break;
  }
  return blend_chain_by<Rule::mean_grey>(frames, shares, boundaries, count, site, sums);
}

HWY_ATTR int take_chain_linear(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                               const PatchSite& site, Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return take_chain_linear_by<Rule::maximum>(frames, boundaries, count, site, sums);
    case Rule::minimum:
      return take_chain_linear_by<Rule::minimum>(frames, boundaries, count, site, sums);
    case Rule::mean_grey:
    case Rule::mean_doppler:
      break;
  }
  return take_chain_linear_by<Rule::mean_grey>(frames, boundaries, count, site, sums);
}

HWY_ATTR void take_rulings(const RulingCell* cells, int count, const RulingLayer* layers, int sample,
                           LaneMask lanes, Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return take_rulings_by<Rule::maximum>(cells, count, layers, sample, lanes, sums);
    case Rule::minimum:
      return take_rulings_by<Rule::minimum>(cells, count, layers, sample, lanes, sums);
    case Rule::mean_grey:
      return take_rulings_by<Rule::mean_grey>(cells, count, layers, sample, lanes, sums);
    case Rule::mean_doppler:
      return take_rulings_by<Rule::mean_doppler>(cells, count, layers, sample, lanes, sums);
  }
}

HWY_ATTR void blend(const LaneGrid& grid, const LinearSide& a, const LinearSide& b, const LaneMask* masks,
                    int layers, Rule rule, PatchSums& sums) {
  switch (rule) {
    case Rule::maximum:
      return blend_by<Rule::maximum>(grid, a, b, masks, layers, sums);
    case Rule::minimum:
      return blend_by<Rule::minimum>(grid, a, b, masks, layers, sums);
    case Rule::mean_grey:
    case Rule::mean_doppler:
      return blend_by<Rule::mean_grey>(grid, a, b, masks, layers, sums);
  }
}

HWY_ATTR void taps_inside(const PatchFrame& f, const std::uint8_t* mask, std::ptrdiff_t mask_stride,
                          const FixedPx* x, const FixedPx* y, int layers, LaneMask* masks) {
#if HWY_TARGET == HWY_AVX3_DL
  if (f.fetch != Fetch::single) {
    PatchFrame of_mask = f;
    of_mask.pixels = mask;
    of_mask.stride = mask_stride;
    if (f.fetch == Fetch::rows) {
      taps_inside_permuted<RowsTaps>(of_mask, x, y, layers, masks);
    } else {
      taps_inside_permuted<WindowTaps>(of_mask, x, y, layers, masks);
    }
    return;
  }
#endif
  taps_inside_single(f, mask, mask_stride, x, y, layers, masks);
}

HWY_ATTR const PatchKernels& kernels_of_target() {
  static constexpr PatchKernels kernels{HWY_TARGET,
                                        lay_lanes,
                                        thresholds,
                                        take_chain,
                                        take_chain_ends,
                                        take_cell,
                                        lay_share,
                                        blend_chain,
                                        take_chain_linear,
                                        take_chain_apart,
                                        lane_positions,
                                        split_positions,
                                        hold,
                                        half_space,
                                        inside,
                                        take,
                                        find_changes,
                                        take_rulings,
                                        blend,
                                        taps_inside,
                                        turn};
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sonoband {

HWY_EXPORT(kernels_of_target);

const PatchKernels& patch_kernels() {
  return HWY_DYNAMIC_DISPATCH(kernels_of_target)();
}

}  // namespace sonoband
#endif
