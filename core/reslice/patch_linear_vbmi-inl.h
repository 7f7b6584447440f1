// Blending bilinear samples whose taps come by byte permutes (patch_taps_vbmi-inl.h): one multiply-add blends
// a pair of bytes. Included once per target that has it.
// clang-format off
#if defined(SONOBAND_PATCH_LINEAR_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_LINEAR_VBMI_INL_H
#undef SONOBAND_PATCH_LINEAR_VBMI_INL_H
#else
#define SONOBAND_PATCH_LINEAR_VBMI_INL_H
#endif
// clang-format on

#include "core/reslice/patch_linear_plain-inl.h"
#include "core/reslice/patch_taps_vbmi-inl.h"
#include "core/reslice/patch_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// a wa + b wb, weights in 1/32768.
HWY_ATTR HWY_INLINE __m512i weighted(__m512i a, __m512i wa, __m512i b, __m512i wb) {
  return _mm512_add_epi16(_mm512_mulhrs_epi16(a, wa), _mm512_mulhrs_epi16(b, wb));
}

// A frame's bilinear values in 1/255 level from the middle, as `bilinear` has them.
template <class FetchTaps>
class Bilinear {
 public:
  HWY_ATTR Bilinear(const PatchFrame& f, bool forward_x, bool forward_y)
      : taps_(f, forward_x, forward_y), part_x_(f.part_x.data()), part_y_(f.part_y.data()) {}

  HWY_ATTR HWY_INLINE Wide at(FixedPx x, FixedPx y) {
    const Taps t = taps_.at(x, y);
    const __m512i add_x = _mm512_set1_epi16(static_cast<short>(x >> 16));
    const __m512i add_y = _mm512_set1_epi16(static_cast<short>(y >> 16));
    return {half(t.upper.low, t.lower.low, add_x, add_y, 0),
            half(t.upper.high, t.lower.high, add_x, add_y, 32)};
  }

 private:
  // 32 lanes from `first` on.
  HWY_ATTR HWY_INLINE __m512i half(__m512i upper, __m512i lower, __m512i add_x, __m512i add_y,
                                   int first) const {
    // Of words, the upper byte is the right tap's weight and the lower one the left's: 255 less it.
    const __m512i right = _mm512_add_epi16(_mm512_load_si512(part_x_ + first), add_x);
    const __m512i across = _mm512_ternarylogic_epi32(right, _mm512_srli_epi16(right, 8),
                                                     _mm512_set1_epi16(static_cast<short>(0xff00)), 0xb1);
    const __m512i down = _mm512_srli_epi16(_mm512_add_epi16(_mm512_load_si512(part_y_ + first), add_y), 1);
    const __m512i up = _mm512_xor_si512(down, _mm512_set1_epi16(0x7fff));
    const __m512i middle = _mm512_set1_epi8(static_cast<char>(0x80));
    return weighted(_mm512_maddubs_epi16(across, _mm512_xor_si512(upper, middle)), up,
                    _mm512_maddubs_epi16(across, _mm512_xor_si512(lower, middle)), down);
  }

  FetchTaps taps_;
  const std::uint16_t *part_x_, *part_y_;
};

// 16 lanes of `shares`.
HWY_ATTR HWY_INLINE __m512i share_quarter(__m512 z, const float* z_lanes, __m512 gap,
                                          const float* gap_lanes) {
  const __m512 full = _mm512_set1_ps(share_full);
  const __m512 at = _mm512_add_ps(z, _mm512_load_ps(z_lanes));
  const __m512 across = _mm512_add_ps(gap, _mm512_load_ps(gap_lanes));
  // One Newton step makes the 14 bits of the estimate a float's.
  const __m512 guess = _mm512_rcp14_ps(across);
  const __m512 inverse = _mm512_mul_ps(guess, _mm512_fnmadd_ps(across, guess, _mm512_set1_ps(2.0F)));
  const __m512 part = _mm512_mul_ps(_mm512_mul_ps(at, full), inverse);
  // 0 where there is no gap.
  return _mm512_cvtps_epi32(_mm512_min_ps(_mm512_max_ps(part, _mm512_setzero_ps()), full));
}

// The second frame's shares z / gap of share_full, in lane order; lanes as ChainShare has them.
HWY_ATTR HWY_INLINE Wide shares(float z, const float* z_lanes, float gap, const float* gap_lanes) {
  const __m512 from = _mm512_set1_ps(z), wide = _mm512_set1_ps(gap);
  const __m512i first = share_quarter(from, z_lanes, wide, gap_lanes);
  const __m512i second = share_quarter(from, z_lanes + 16, wide, gap_lanes + 16);
  const __m512i third = share_quarter(from, z_lanes + 32, wide, gap_lanes + 32);
  const __m512i fourth = share_quarter(from, z_lanes + 48, wide, gap_lanes + 48);
  return {_mm512_packs_epi32(first, second), _mm512_packs_epi32(third, fourth)};
}

// As `even_share`, of 32 lanes.
HWY_ATTR HWY_INLINE __m512i even_half(const std::uint16_t* part_lanes, __m512i part_at,
                                      const std::uint16_t* bend_lanes, __m512i bend_at) {
  const __m512i part = _mm512_add_epi16(part_at, _mm512_load_si512(part_lanes));
  const __m512i bend = _mm512_add_epi16(bend_at, _mm512_load_si512(bend_lanes));
  const __m512i two = _mm512_sub_epi16(bend, _mm512_mulhrs_epi16(bend, bend));
  const __m512i three = _mm512_sub_epi16(bend, _mm512_mulhrs_epi16(bend, two));
  return _mm512_sub_epi16(part, _mm512_mulhrs_epi16(part, three));
}
HWY_ATTR HWY_INLINE Wide even_shares(const ChainShare& share, FixedPx part_at, FixedPx bend_at) {
  const __m512i part = _mm512_set1_epi16(static_cast<short>(part_at >> 32));
  const __m512i bend = _mm512_set1_epi16(static_cast<short>(bend_at >> 32));
  const std::uint16_t *part_lanes = share.part_lanes.data(), *bend_lanes = share.bend_lanes.data();
  return {even_half(part_lanes, part, bend_lanes, bend),
          even_half(part_lanes + 32, part, bend_lanes + 32, bend)};
}

// Values of two frames to levels, as `blended`.
HWY_ATTR HWY_INLINE __m512i blended_half(__m512i a, __m512i b, __m512i of_b) {
  const __m512i full = _mm512_set1_epi16(share_full), offset = _mm512_set1_epi16(blend_offset);
  const __m512i sum = weighted(a, _mm512_sub_epi16(full, of_b), b, of_b);
  return _mm512_srli_epi16(_mm512_add_epi16(sum, offset), 7);
}
HWY_ATTR HWY_INLINE Wide blended_words(Wide a, Wide b, Wide share) {
  return {blended_half(a.low, b.low, share.low), blended_half(a.high, b.high, share.high)};
}
HWY_ATTR HWY_INLINE Wide levels_of(Wide a) {
  const __m512i full = _mm512_set1_epi16(share_full), offset = _mm512_set1_epi16(blend_offset);
  return {_mm512_srli_epi16(_mm512_add_epi16(_mm512_mulhrs_epi16(a.low, full), offset), 7),
          _mm512_srli_epi16(_mm512_add_epi16(_mm512_mulhrs_epi16(a.high, full), offset), 7)};
}

// At arrays of positions.
template <class FetchTaps>
HWY_ATTR Bilinear<FetchTaps> bilinear_of(const LinearSide& side, int layers) {
  return {*side.frame, layers < 2 || side.x[1] >= side.x[0], layers < 2 || side.y[1] >= side.y[0]};
}

template <Rule rule, class FetchA, class FetchB>
HWY_ATTR void blend_permuted(const LaneGrid& grid, const LinearSide& a, const LinearSide& b,
                             const LaneMask* masks, int layers, PatchSums& sums) {
  Bilinear<FetchA> of_a = bilinear_of<FetchA>(a, layers);
  Bilinear<FetchB> of_b = bilinear_of<FetchB>(b, layers);
  alignas(64) float z[patch_lanes], gap[patch_lanes];
  for (int k = 0; k < patch_lanes; ++k) {
    z[share_place(k)] = a.z_per_sample * grid.a[k] + a.z_per_row * grid.b[k];
    gap[share_place(k)] = z[share_place(k)] - (b.z_per_sample * grid.a[k] + b.z_per_row * grid.b[k]);
  }
  Gathered<rule> gathered(sums);
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    const Wide va = of_a.at(a.x[l], a.y[l]), vb = of_b.at(b.x[l], b.y[l]);
    const Wide v = blended_words(va, vb, shares(a.z[l], z, a.z[l] - b.z[l], gap));
    gathered.add_words(masks[l], v.low, v.high);
  }
  gathered.store();
}

template <Rule rule>
HWY_ATTR void blend_by(const LaneGrid& grid, const LinearSide& a, const LinearSide& b, const LaneMask* masks,
                       int layers, PatchSums& sums) {
  const Fetch fa = a.frame->fetch, fb = b.frame->fetch;
  if (fa == Fetch::rows && fb == Fetch::rows) {
    blend_permuted<rule, RowsTaps, RowsTaps>(grid, a, b, masks, layers, sums);
  } else if (fa == Fetch::window && fb == Fetch::window) {
    blend_permuted<rule, WindowTaps, WindowTaps>(grid, a, b, masks, layers, sums);
  } else if (fa == Fetch::rows && fb == Fetch::window) {
    blend_permuted<rule, RowsTaps, WindowTaps>(grid, a, b, masks, layers, sums);
  } else if (fa == Fetch::window && fb == Fetch::rows) {
    blend_permuted<rule, WindowTaps, RowsTaps>(grid, a, b, masks, layers, sums);
  } else {
    blend_single<rule>(grid, a, b, masks, layers, sums);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
