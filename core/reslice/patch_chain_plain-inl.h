// Patches of a chain for any instruction set, cell by cell and layer by layer. Included once per target
// (empty where byte permutes do the same).
// clang-format off
#if defined(SONOBAND_PATCH_CHAIN_PLAIN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_CHAIN_PLAIN_INL_H
#undef SONOBAND_PATCH_CHAIN_PLAIN_INL_H
#else
#define SONOBAND_PATCH_CHAIN_PLAIN_INL_H
#endif
// clang-format on

#include <algorithm>

#include "core/reslice/chain_walk.h"
#include "core/reslice/patch_linear_plain-inl.h"
#include "core/reslice/patch_plain-inl.h"

#if HWY_TARGET != HWY_AVX3_DL
HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

HWY_ATTR inline void thresholds(const ChainBoundary& boundary, const PatchSite& site, LayerThresholds& out) {
  out.rising = boundary.rising;
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
}

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

HWY_ATTR inline void hold(const LayerThresholds& thresholds, bool holding, int first, int last,
                          LaneMask* masks) {
  const LaneMask flip = thresholds.rising == holding ? 0 : ~LaneMask{0};
  for (int l = first; l < last; ++l)
    masks[l - first] &= not_above(thresholds.layer.data(), static_cast<std::uint8_t>(l)) ^ flip;
}

HWY_ATTR inline void lay_lanes(const LaneGrid& grid, ChainBoundary& b) {
  lane_offsets(grid, b.per_sample, b.per_row, b.lanes.data());
  b.least = *std::min_element(b.lanes.begin(), b.lanes.end());
  b.greatest = *std::max_element(b.lanes.begin(), b.lanes.end());
}

HWY_ATTR inline void half_space(const LaneGrid& grid, const float* base, float per_sample, float per_row,
                                int layers, LaneMask* masks) {
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

HWY_ATTR inline int take_chain_apart(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
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

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();
#endif

#endif
