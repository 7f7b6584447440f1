// Fetching and compounding for any instruction set, over Highway. Included once per target.
// clang-format off
#if defined(SONOBAND_PATCH_PLAIN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_PLAIN_INL_H
#undef SONOBAND_PATCH_PLAIN_INL_H
#else
#define SONOBAND_PATCH_PLAIN_INL_H
#endif
// clang-format on

#include <hwy/highway.h>

#include <algorithm>

#include "core/image/doppler.h"
#include "core/reslice/patch.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Lane groups of the widest vector that still divides a patch.
using Bytes = hn::CappedTag<std::uint8_t, patch_lanes>;
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::CappedTag<std::int32_t, 16>;

// The pixel of every lane, in 1/1 pixels; a lane outside the picture gets the nearest inside.
HWY_ATTR inline void pixel_indices(const PatchFrame& f, FixedPx x, FixedPx y, std::ptrdiff_t stride,
                                   std::int32_t* indices) {
  const Ints d;
  const auto at_x = hn::Set(d, static_cast<std::int32_t>(x >> 16));
  const auto at_y = hn::Set(d, static_cast<std::int32_t>(y >> 16));
  const auto zero = hn::Zero(d);
  const auto last_x = hn::Set(d, f.width - 1), last_y = hn::Set(d, f.height - 1);
  const auto row_length = hn::Set(d, static_cast<std::int32_t>(stride));
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    const auto px = hn::ShiftRight<16>(hn::Add(at_x, hn::Load(d, f.offset_x.data() + k)));
    const auto py = hn::ShiftRight<16>(hn::Add(at_y, hn::Load(d, f.offset_y.data() + k)));
    const auto inside_x = hn::Min(hn::Max(px, zero), last_x);
    const auto inside_y = hn::Min(hn::Max(py, zero), last_y);
    hn::Store(hn::Add(hn::Mul(inside_y, row_length), inside_x), d, indices + k);
  }
}

// Lanes whose pixel is the picture's.
HWY_ATTR inline LaneMask in_picture(const PatchFrame& f, FixedPx x, FixedPx y) {
  const Ints d;
  const auto at_x = hn::Set(d, static_cast<std::int32_t>(x >> 16));
  const auto at_y = hn::Set(d, static_cast<std::int32_t>(y >> 16));
  const auto before_x = hn::Set(d, f.first_x - 1), behind_x = hn::Set(d, f.last_x + 1);
  const auto before_y = hn::Set(d, f.first_y - 1), behind_y = hn::Set(d, f.last_y + 1);
  LaneMask inside = 0;
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    const auto px = hn::ShiftRight<16>(hn::Add(at_x, hn::Load(d, f.offset_x.data() + k)));
    const auto py = hn::ShiftRight<16>(hn::Add(at_y, hn::Load(d, f.offset_y.data() + k)));
    const auto in = hn::And(hn::And(hn::Gt(px, before_x), hn::Lt(px, behind_x)),
                            hn::And(hn::Gt(py, before_y), hn::Lt(py, behind_y)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, in, bits);
    LaneMask part = 0;
    for (std::size_t i = 0; i < (hn::Lanes(d) + 7) / 8; ++i) part |= LaneMask{bits[i]} << (8 * i);
    inside |= part << k;
  }
  return inside;
}

// Of `lanes` those whose pixel is the picture's and in its mask.
HWY_ATTR inline LaneMask inside_single(const PatchFrame& f, FixedPx x, FixedPx y, LaneMask lanes) {
  if (lanes == 0) return 0;
  lanes &= in_picture(f, x, y);
  if (f.mask == nullptr) return lanes;
  alignas(64) std::int32_t indices[patch_lanes];
  pixel_indices(f, x, y, f.mask_stride, indices);
  LaneMask kept = 0;
  for (int k = 0; k < patch_lanes; ++k) kept |= LaneMask{f.mask[indices[k]] != 0} << k;
  return lanes & kept;
}

HWY_ATTR inline void fetch_single(const PatchFrame& f, FixedPx x, FixedPx y, std::uint8_t* values) {
  alignas(64) std::int32_t indices[patch_lanes];
  pixel_indices(f, x, y, f.stride, indices);
  for (int k = 0; k < patch_lanes; ++k) values[k] = f.pixels[indices[k]];
}

HWY_ATTR inline auto lanes_of(LaneMask mask, std::size_t first) {
  const Bytes d;
  std::uint8_t bits[16] = {};
  const LaneMask shifted = mask >> first;
  for (int i = 0; i < 8; ++i) bits[i] = static_cast<std::uint8_t>(shifted >> (8 * i));
  return hn::LoadMaskBits(d, bits);
}

template <Rule rule>
HWY_ATTR void compound_lanes(const std::uint8_t* values, LaneMask mask, PatchSums& sums) {
  const Bytes d;
  const auto one = hn::Set(d, 1);
  [[maybe_unused]] alignas(64) std::uint8_t kept[patch_lanes];
  for (std::size_t k = 0; k < patch_lanes; k += hn::Lanes(d)) {
    const auto m = lanes_of(mask, k);
    const auto v = hn::Load(d, values + k);
    const auto count = hn::Load(d, sums.count.data() + k);
    hn::Store(hn::Add(count, hn::IfThenElseZero(m, one)), d, sums.count.data() + k);
    if constexpr (rule == Rule::maximum || rule == Rule::minimum) {
      const auto old = hn::Load(d, sums.extreme.data() + k);
      const auto best = rule == Rule::maximum ? hn::Max(old, v) : hn::Min(old, v);
      hn::Store(hn::IfThenElse(m, best, old), d, sums.extreme.data() + k);
    } else if constexpr (rule == Rule::mean_grey) {
      hn::Store(hn::IfThenElseZero(m, v), d, kept + k);
    }
  }
  if constexpr (rule == Rule::mean_grey) {
    for (int k = 0; k < patch_lanes; ++k) sums.sum[k] = static_cast<std::uint16_t>(sums.sum[k] + kept[k]);
  } else if constexpr (rule == Rule::mean_doppler) {
    for (int k = 0; k < patch_lanes; ++k) {
      if (((mask >> k) & 1) == 0) continue;
      if (doppler::is_colour(values[k])) {
        sums.velocity[k] = static_cast<std::int16_t>(sums.velocity[k] + doppler::velocity(values[k]));
        ++sums.coloured[k];
      } else {
        sums.sum[k] = static_cast<std::uint16_t>(sums.sum[k] + values[k]);
      }
    }
  }
}

template <Rule rule>
HWY_ATTR void take_single(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                          int layers, PatchSums& sums) {
  alignas(64) std::uint8_t values[patch_lanes];
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    fetch_single(f, x[l], y[l], values);
    compound_lanes<rule>(values, masks[l], sums);
  }
}

// Lane offsets of an affine function.
HWY_ATTR inline void lane_offsets(const LaneGrid& grid, float per_sample, float per_row, float* offsets) {
  for (int k = 0; k < patch_lanes; ++k) offsets[k] = per_sample * grid.a[k] + per_row * grid.b[k];
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
