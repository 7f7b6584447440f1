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

#include <cmath>

#include "core/reslice/patch_plain-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

constexpr int blend_offset = 128 * 128 + 64;  // the middle level, and a half

// Where ChainShare keeps a lane: packing two vectors of 32-bit numbers to 16 bits mixes their quarters, and
// stored in this order they come out in lane order.
constexpr int share_place(int lane) {
  return 16 * (2 * (lane / 32) + lane / 4 % 2) + 4 * (lane / 8 % 4) + lane % 4;
}

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

// a b / 2^15, rounded: what the vector instruction gives.
HWY_ATTR inline std::int32_t times(std::int32_t a, std::int32_t b) {
  return (a * b + (1 << 14)) >> 15;
}

// In 1/255 level from the middle, 128: 16 bits. Weights of 8 bits along x, of 15 along y.
HWY_ATTR inline std::int32_t bilinear(const PatchFrame& f, FixedPx x, FixedPx y, int k) {
  const LaneTaps t = lane_taps(f, x, y, k);
  const auto across = [&](std::int32_t row) {
    const std::uint8_t* pixels = f.pixels + row * f.stride;
    const auto right = static_cast<std::int32_t>(t.part_x >> 8);
    return (pixels[t.left] - 128) * (255 - right) + (pixels[t.right] - 128) * right;
  };
  const auto lower = static_cast<std::int32_t>(t.part_y >> 1);
  return times(across(t.top), 32767 - lower) + times(across(t.bottom), lower);
}

// Of two bilinear values, share / share_full of the second.
HWY_ATTR inline std::uint8_t blended(std::int32_t a, std::int32_t b, std::int32_t share) {
  return static_cast<std::uint8_t>((times(a, share_full - share) + times(b, share) + blend_offset) >> 7);
}

// Cut off to 16 bits, as the vector code's sums are.
HWY_ATTR inline std::int16_t sum16(std::uint16_t lane, FixedPx at) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(lane + static_cast<std::uint16_t>(at >> 32)));
}

// part / (1 + bend), by 1 - bend + bend^2 - bend^3.
HWY_ATTR inline std::int32_t even_share(const ChainShare& share, FixedPx part_at, FixedPx bend_at, int k) {
  const std::int32_t part = sum16(share.part_lanes[k], part_at), bend = sum16(share.bend_lanes[k], bend_at);
  return part - times(part, bend - times(bend, bend - times(bend, bend)));
}

// 0 .. 1 as a share.
HWY_ATTR inline std::int32_t share_of(float part) {
  return static_cast<std::int32_t>(std::lrintf(std::min(std::max(part, 0.0F), 1.0F) * share_full));
}

// share_at(l, k): of frame b, in 1 / share_full.
template <Rule rule, class ShareAt>
HWY_ATTR void blend_lanes(const PatchFrame& a, const FixedPx* xa, const FixedPx* ya, const PatchFrame& b,
                          const FixedPx* xb, const FixedPx* yb, ShareAt share_at, const LaneMask* masks,
                          int layers, PatchSums& sums) {
  alignas(64) std::uint8_t values[patch_lanes] = {};
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    for (int k = 0; k < patch_lanes; ++k) {
      if (((masks[l] >> k) & 1) == 0) continue;
      values[k] = blended(bilinear(a, xa[l], ya[l], k), bilinear(b, xb[l], yb[l], k), share_at(l, k));
    }
    compound_lanes<rule>(values, masks[l], sums);
  }
}

template <Rule rule>
HWY_ATTR void blend_single(const LaneGrid& grid, const LinearSide& a, const LinearSide& b,
                           const LaneMask* masks, int layers, PatchSums& sums) {
  const auto share_at = [&](int l, int k) {
    const float za = a.z[l] + (a.z_per_sample * grid.a[k] + a.z_per_row * grid.b[k]);
    const float zb = b.z[l] + (b.z_per_sample * grid.a[k] + b.z_per_row * grid.b[k]);
    return share_of(za != zb ? za / (za - zb) : 0);
  };
  blend_lanes<rule>(*a.frame, a.x, a.y, *b.frame, b.x, b.y, share_at, masks, layers, sums);
}

// One layer of a chain's cell between frames a and b, or of one frame where `share` is null.
template <Rule rule>
HWY_ATTR void blend_layer(const ChainFrame& a, const ChainFrame& b, const ChainShare* share,
                          const PatchSite& site, int l, LaneMask mask, PatchSums& sums) {
  const FixedPx xa = a.x_at(site, l) + foot_from_position, ya = a.y_at(site, l) + foot_from_position;
  const FixedPx xb = b.x_at(site, l) + foot_from_position, yb = b.y_at(site, l) + foot_from_position;
  const auto blend = [&](auto share_at) HWY_ATTR {
    blend_lanes<rule>(*a.frame, &xa, &ya, *b.frame, &xb, &yb, share_at, &mask, 1, sums);
  };
  if (share == nullptr) return blend([](int, int) { return 0; });
  if (share->even) {
    const FixedPx part = share->part.at(site, l), bend = share->bend.at(site, l);
    return blend([&](int, int k) HWY_ATTR { return even_share(*share, part, bend, k); });
  }
  const float z = share->z.at(site, l), gap = share->gap.at(site, l);
  blend([&](int, int k) HWY_ATTR {
    const int place = share_place(k);
    return share_of((z + share->z_lanes[place]) / (gap + share->gap_lanes[place]));
  });
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
