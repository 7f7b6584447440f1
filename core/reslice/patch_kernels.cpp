// The vector code of patches, compiled once for each instruction set and chosen at run time by Highway.
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/reslice/patch_kernels.cpp"
#define HWY_WANT_AVX3_DL 1  // Ice Lake, Zen 4 and later: byte permutes
#include <hwy/foreach_target.h>
// Highway's per-target headers come after foreach_target.h.
#include <hwy/highway.h>

#include "core/reslice/chain_walk.h"
#include "core/reslice/patch.h"
#include "core/reslice/patch_linear_plain-inl.h"
#include "core/reslice/patch_plain-inl.h"
#include "core/reslice/patch_rulings-inl.h"
#include "core/reslice/patch_turn-inl.h"
#if HWY_TARGET == HWY_AVX3_DL
#include "core/reslice/patch_chain_vbmi-inl.h"
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

HWY_ATTR void thresholds(const ChainBoundary& boundary, const PatchSite& site, LayerThresholds& out) {
  out.rising = boundary.rising;
#if HWY_TARGET == HWY_AVX3_DL
  _mm512_store_si512(out.layer.data(), threshold_layers(boundary, boundary.at(site)));
#else
  const Floats d;
  const hn::Rebind<std::int32_t, Floats> ints;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const auto at = hn::Set(d, boundary.at(site));
  const auto zero = hn::Zero(d), most = hn::Set(d, 255.0F), one = hn::Set(d, 1.0F);
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    const auto crossing = hn::Add(at, hn::Load(d, boundary.lanes.data() + k));
    // Bounded before rounding: the conversion to integers must not overflow.
    const auto bounded = hn::Min(hn::Max(crossing, hn::Neg(one)), most);
    const auto layer = boundary.rising ? hn::Ceil(bounded) : hn::Add(hn::Floor(bounded), one);
    const auto clamped = hn::Min(hn::Max(layer, zero), most);
    hn::StoreU(hn::DemoteTo(bytes, hn::ConvertTo(ints, clamped)), bytes, out.layer.data() + k);
  }
#endif
}

// Lane offsets of an affine function.
HWY_ATTR inline void lane_offsets(const LaneGrid& grid, float per_sample, float per_row, float* offsets) {
  for (int k = 0; k < patch_lanes; ++k) offsets[k] = per_sample * grid.a[k] + per_row * grid.b[k];
}

HWY_ATTR void inside(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers, LaneMask* masks) {
#if HWY_TARGET == HWY_AVX3_DL
  if (f.fetch != Fetch::single) return inside_permuted(f, x, y, layers, masks);
#endif
  for (int l = 0; l < layers; ++l) masks[l] = inside_single(f, x[l], y[l], masks[l]);
}

#if HWY_TARGET == HWY_AVX3_DL

HWY_ATTR void hold(const LayerThresholds& thresholds, bool holding, int first, int last, LaneMask* masks) {
  const __m512i layers = _mm512_load_si512(thresholds.layer.data());
  const LaneMask flip = thresholds.rising == holding ? 0 : ~LaneMask{0};
  for (int l = first; l < last; ++l)
    masks[l - first] &= _mm512_cmple_epu8_mask(layers, _mm512_set1_epi8(static_cast<char>(l))) ^ flip;
}

HWY_ATTR void half_space(const LaneGrid& grid, const float* base, float per_sample, float per_row, int layers,
                         LaneMask* masks) {
  alignas(64) float lane_offset[patch_lanes];
  lane_offsets(grid, per_sample, per_row, lane_offset);
  __m512 offset[4];
  for (int i = 0; i < 4; ++i) offset[i] = _mm512_load_ps(lane_offset + 16 * i);
  for (int l = 0; l < layers; ++l) {
    const __m512 least = _mm512_set1_ps(-base[l]);
    LaneMask m = 0;
    for (int i = 0; i < 4; ++i) m |= LaneMask{_mm512_cmp_ps_mask(offset[i], least, _CMP_GE_OQ)} << (16 * i);
    masks[l] = m;
  }
}

template <Rule rule>
HWY_ATTR void take_by(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                      int layers, PatchSums& sums) {
  switch (f.fetch) {
    case Fetch::rows:
      return take_permuted<rule, RowsFetch>(f, x, y, masks, layers, sums);
    case Fetch::window:
      return take_permuted<rule, WindowFetch>(f, x, y, masks, layers, sums);
    case Fetch::single:
      return take_single<rule>(f, x, y, masks, layers, sums);
  }
}

#else

HWY_ATTR inline LaneMask not_above(const std::uint8_t* values, std::uint8_t most) {
  const Bytes d;
  const auto bound = hn::Set(d, most);
  LaneMask mask = 0;
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    alignas(8) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Eq(hn::Min(hn::Load(d, values + k), bound), hn::Load(d, values + k)), bits);
    LaneMask part = 0;
    for (std::size_t i = 0; i < (hn::Lanes(d) + 7) / 8; ++i) part |= LaneMask{bits[i]} << (8 * i);
    mask |= part << k;
  }
  return mask;
}

HWY_ATTR void hold(const LayerThresholds& thresholds, bool holding, int first, int last, LaneMask* masks) {
  const LaneMask flip = thresholds.rising == holding ? 0 : ~LaneMask{0};
  for (int l = first; l < last; ++l)
    masks[l - first] &= not_above(thresholds.layer.data(), static_cast<std::uint8_t>(l)) ^ flip;
}

HWY_ATTR void lay_lanes(const LaneGrid& grid, ChainBoundary& b) {
  lane_offsets(grid, b.per_sample, b.per_row, b.lanes.data());
  b.least = *std::min_element(b.lanes.begin(), b.lanes.end());
  b.greatest = *std::max_element(b.lanes.begin(), b.lanes.end());
}

HWY_ATTR void half_space(const LaneGrid& grid, const float* base, float per_sample, float per_row, int layers,
                         LaneMask* masks) {
  alignas(64) float lane_offset[patch_lanes];
  lane_offsets(grid, per_sample, per_row, lane_offset);
  const Floats d;
  for (int l = 0; l < layers; ++l) {
    const auto least = hn::Set(d, -base[l]);
    LaneMask mask = 0;
    for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
      alignas(8) std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Ge(hn::LoadU(d, lane_offset + k), least), bits);
      LaneMask part = 0;
      for (std::size_t i = 0; i < (hn::Lanes(d) + 7) / 8; ++i) part |= LaneMask{bits[i]} << (8 * i);
      mask |= part << k;
    }
    masks[l] = mask;
  }
}

template <Rule rule>
HWY_ATTR void take_by(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                      int layers, PatchSums& sums) {
  take_single<rule>(f, x, y, masks, layers, sums);
}

// Calls visit(cell, l, lanes) for every layer of every cell.
template <class Visit>
HWY_ATTR int walk_layers(const ChainBoundary* boundaries, int count, const PatchSite& site, Visit visit) {
  LaneMask masks[patch_layers];
  LayerThresholds scratch;
  return walk_chain(boundaries, count, site,
                    [&](int cell, const ChainBoundary* from, const ChainBoundary* to, const LayerRange& range)
                        HWY_ATTR {
                          std::fill(masks, masks + (range.high - range.low), site.lanes);
                          if (from != nullptr) {
                            thresholds(*from, site, scratch);
                            hold(scratch, true, range.low, range.high, masks);
                          }
                          if (to != nullptr) {
                            thresholds(*to, site, scratch);
                            hold(scratch, false, range.low, range.high, masks);
                          }
                          for (int l = range.low; l < range.high; ++l) visit(cell, l, masks[l - range.low]);
                        });
}

template <Rule rule>
HWY_ATTR int take_chain_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                           const PatchSite& site, PatchSums& sums) {
  return walk_layers(boundaries, count, site, [&](int cell, int l, LaneMask mask) HWY_ATTR {
    const ChainFrame& f = frames[cell];
    const FixedPx x = f.x_at(site, l), y = f.y_at(site, l);
    take_single<rule>(*f.frame, &x, &y, &mask, 1, sums);
  });
}

template <Rule rule>
HWY_ATTR int take_chain_ends_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                const PatchSite& site, PatchSums& sums, LaneMask* without) {
  return walk_layers(boundaries, count, site, [&](int cell, int l, LaneMask mask) HWY_ATTR {
    const ChainFrame& f = frames[cell];
    const FixedPx x = f.x_at(site, l), y = f.y_at(site, l);
    const LaneMask in = inside_single(*f.frame, x, y, mask);
    without[l] |= mask & ~in;
    take_single<rule>(*f.frame, &x, &y, &in, 1, sums);
  });
}

template <Rule rule>
HWY_ATTR int blend_chain_by(const ChainFrame* frames, const ChainShare* shares,
                            const ChainBoundary* boundaries, int count, const PatchSite& site,
                            PatchSums& sums) {
  return walk_layers(boundaries, count, site, [&](int cell, int l, LaneMask mask) HWY_ATTR {
    const bool alone = cell == 0 || cell == count - 1;
    const ChainFrame& a = frames[std::max(cell - 1, 0)];
    blend_layer<rule>(a, alone ? a : frames[cell], alone ? nullptr : shares + cell - 1, site, l, mask, sums);
  });
}

template <Rule rule>
HWY_ATTR int take_chain_linear_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                  const PatchSite& site, PatchSums& sums) {
  return walk_layers(boundaries, count, site, [&](int cell, int l, LaneMask mask) HWY_ATTR {
    blend_layer<rule>(frames[cell], frames[cell], nullptr, site, l, mask, sums);
  });
}

HWY_ATTR int take_chain_apart(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                              const PatchSite& site, PatchLayers& layers) {
  return walk_layers(boundaries, count, site, [&](int cell, int l, LaneMask mask) HWY_ATTR {
    if (mask == 0) return;
    const ChainFrame& f = frames[cell];
    alignas(64) std::uint8_t values[patch_lanes];
    fetch_single(*f.frame, f.x_at(site, l), f.y_at(site, l), values);
    const Bytes d;
    std::uint8_t* out = layers.values[l].data();
    for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d))
      hn::Store(hn::IfThenElse(lanes_of(mask, k), hn::Load(d, values + k), hn::Load(d, out + k)), d, out + k);
    for (int k = 0; k < patch_lanes; ++k)
      layers.has_data[k] = static_cast<std::uint16_t>(layers.has_data[k] | (mask >> k & 1) << l);
  });
}

template <Rule rule>
HWY_ATTR void blend_by(const LaneGrid& grid, const LinearSide& a, const LinearSide& b, const LaneMask* masks,
                       int layers, PatchSums& sums) {
  blend_single<rule>(grid, a, b, masks, layers, sums);
}

#endif

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
