// Blending bilinear samples for any instruction set: the same whole-number arithmetic as the permuting
// kernel. Included once per target.
// clang-format off
#if defined(SONOBAND_PATCH_LINEAR_PLAIN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_LINEAR_PLAIN_INL_H
#undef SONOBAND_PATCH_LINEAR_PLAIN_INL_H
#else
#define SONOBAND_PATCH_LINEAR_PLAIN_INL_H
#endif
// clang-format on

#include "core/reslice/patch_plain-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// The four taps of one lane, those beyond the edge moved onto it, and how far the foot is from the first.
struct LaneTaps {
  std::int32_t left, right, top, bottom;
  std::uint32_t part_x, part_y;  // 1/65536
};

HWY_ATTR inline LaneTaps lane_taps(const PatchFrame& f, FixedPx x, FixedPx y, int k) {
  const std::int32_t at_x = static_cast<std::int32_t>(x >> 16) + f.offset_x[k];
  const std::int32_t at_y = static_cast<std::int32_t>(y >> 16) + f.offset_y[k];
  const std::int32_t column = at_x >> 16, row = at_y >> 16;
  return {std::clamp(column, 0, f.width - 1),        std::clamp(column + 1, 0, f.width - 1),
          std::clamp(row, 0, f.height - 1),          std::clamp(row + 1, 0, f.height - 1),
          static_cast<std::uint32_t>(at_x & 0xffff), static_cast<std::uint32_t>(at_y & 0xffff)};
}

// a (1 - t) + b t with t in 1/65536, of numbers in 1/256 level.
HWY_ATTR inline std::uint32_t lerp(std::uint32_t a, std::uint32_t b, std::uint32_t t) {
  return (a * (65535 - t) >> 16) + (b * t >> 16);
}

HWY_ATTR inline std::uint32_t bilinear(const PatchFrame& f, FixedPx x, FixedPx y, int k) {
  const LaneTaps t = lane_taps(f, x, y, k);
  const std::uint8_t* top = f.pixels + t.top * f.stride;
  const std::uint8_t* bottom = f.pixels + t.bottom * f.stride;
  const std::uint32_t upper =
      lerp(std::uint32_t{top[t.left]} << 8, std::uint32_t{top[t.right]} << 8, t.part_x);
  const std::uint32_t lower =
      lerp(std::uint32_t{bottom[t.left]} << 8, std::uint32_t{bottom[t.right]} << 8, t.part_x);
  return lerp(upper, lower, t.part_y);
}

// What the cut-off parts of three blends amount to on average, and a half: added before the last rounding.
constexpr std::uint32_t blend_rounding = 128 + 3;

template <Rule rule>
HWY_ATTR void blend_single(const LaneGrid& grid, const LinearSide& a, const LinearSide& b,
                           const LaneMask* masks, int layers, PatchSums& sums) {
  alignas(64) std::uint8_t values[patch_lanes] = {};
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    for (int k = 0; k < patch_lanes; ++k) {
      if (((masks[l] >> k) & 1) == 0) continue;
      const float za = a.z[l] + (a.z_per_sample * grid.a[k] + a.z_per_row * grid.b[k]);
      const float zb = b.z[l] + (b.z_per_sample * grid.a[k] + b.z_per_row * grid.b[k]);
      // b's weight is the share of a's distance.
      const float share = std::clamp(za / (za - zb) * 65536.0F, 0.0F, 65535.0F);
      const std::uint32_t value =
          lerp(bilinear(*a.frame, a.x[l], a.y[l], k), bilinear(*b.frame, b.x[l], b.y[l], k),
               static_cast<std::uint32_t>(share + 0.5F > 65535.0F ? 65535.0F : share + 0.5F));
      values[k] = static_cast<std::uint8_t>(std::min(value + blend_rounding, 65535U) >> 8);
    }
    compound_lanes<rule>(values, masks[l], sums);
  }
}

HWY_ATTR inline void taps_inside_single(const PatchFrame& f, const std::uint8_t* mask,
                                        std::ptrdiff_t mask_stride, const FixedPx* x, const FixedPx* y,
                                        int layers, LaneMask* masks) {
  for (int l = 0; l < layers; ++l) {
    LaneMask kept = 0;
    for (int k = 0; k < patch_lanes; ++k) {
      if (((masks[l] >> k) & 1) == 0) continue;
      const LaneTaps t = lane_taps(f, x[l], y[l], k);
      const std::uint8_t* top = mask + t.top * mask_stride;
      const std::uint8_t* bottom = mask + t.bottom * mask_stride;
      const bool all = top[t.left] != 0 && top[t.right] != 0 && bottom[t.left] != 0 && bottom[t.right] != 0;
      kept |= LaneMask{all} << k;
    }
    masks[l] = kept;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
