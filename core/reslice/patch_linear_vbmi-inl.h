// Blending bilinear samples by byte permutes (AVX-512 VBMI). One permute fetches the left and the right taps
// of 32 lanes as pairs of bytes, which one multiply-add blends. Included once per target that has it.
// clang-format off
#if defined(SONOBAND_PATCH_LINEAR_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_LINEAR_VBMI_INL_H
#undef SONOBAND_PATCH_LINEAR_VBMI_INL_H
#else
#define SONOBAND_PATCH_LINEAR_VBMI_INL_H
#endif
// clang-format on

#include "core/reslice/patch_linear_plain-inl.h"
#include "core/reslice/patch_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// 64 words, lanes in order.
struct Wide {
  __m512i low, high;
};

// The left and the right tap of each lane, as the two bytes of a word.
struct Taps {
  Wide upper, lower;
};

// Bytes of 64 lanes as words.
HWY_ATTR HWY_INLINE Wide words_of(const std::uint8_t* bytes) {
  return {_mm512_cvtepu8_epi16(_mm256_load_si256(reinterpret_cast<const __m256i*>(bytes))),
          _mm512_cvtepu8_epi16(_mm256_load_si256(reinterpret_cast<const __m256i*>(bytes + 32)))};
}
HWY_ATTR HWY_INLINE __m512i in_both_bytes(__m512i words) {
  return _mm512_or_si512(words, _mm512_slli_epi16(words, 8));
}

// Whole parts by lane, to which the carries of the fractional parts are added.
class Whole {
 public:
  HWY_ATTR Whole(Wide whole, const std::uint16_t* parts)
      : whole_(whole), low_(_mm512_load_si512(parts)), high_(_mm512_load_si512(parts + 32)) {}
  HWY_ATTR HWY_INLINE Wide at(FixedPx position, short carry) const {
    const __m512i most = _mm512_set1_epi16(static_cast<short>(~(position >> 16)));
    const __m512i more = _mm512_set1_epi16(carry);
    return {_mm512_mask_add_epi16(whole_.low, _mm512_cmpgt_epu16_mask(low_, most), whole_.low, more),
            _mm512_mask_add_epi16(whole_.high, _mm512_cmpgt_epu16_mask(high_, most), whole_.high, more)};
  }
  HWY_ATTR HWY_INLINE Wide add_carries(Wide to, FixedPx position, short carry) const {
    const __m512i most = _mm512_set1_epi16(static_cast<short>(~(position >> 16)));
    const __m512i more = _mm512_set1_epi16(carry);
    return {_mm512_mask_add_epi16(to.low, _mm512_cmpgt_epu16_mask(low_, most), to.low, more),
            _mm512_mask_add_epi16(to.high, _mm512_cmpgt_epu16_mask(high_, most), to.high, more)};
  }

 private:
  Wide whole_;
  __m512i low_, high_;
};

// Columns of both taps.
HWY_ATTR HWY_INLINE Wide column_pairs(const PatchFrame& f) {
  const Wide columns = words_of(f.column.data());
  const __m512i right = _mm512_set1_epi16(0x100);
  return {_mm512_add_epi16(in_both_bytes(columns.low), right),
          _mm512_add_epi16(in_both_bytes(columns.high), right)};
}
HWY_ATTR HWY_INLINE Wide row_pairs(const PatchFrame& f) {
  const Wide rows = words_of(f.row.data());
  return {in_both_bytes(rows.low), in_both_bytes(rows.high)};
}

// Bytes moved by `shift`, into [least, most].
HWY_ATTR HWY_INLINE Wide clamped(Wide bytes, int shift, int least, int most) {
  const auto one = [&](__m512i v) HWY_ATTR {
    const __m512i moved = _mm512_add_epi8(v, _mm512_set1_epi8(static_cast<char>(shift)));
    return _mm512_min_epi8(_mm512_max_epi8(moved, _mm512_set1_epi8(static_cast<char>(least))),
                           _mm512_set1_epi8(static_cast<char>(most)));
  };
  return {one(bytes.low), one(bytes.high)};
}

// Lanes on few rows of the picture.
class RowsTaps {
 public:
  HWY_ATTR RowsTaps(const PatchFrame& f, bool, bool)
      : f_(f),
        reach_(f.columns + 2 < 80 ? 80 : 128),
        room_(f.width - reach_),
        columns_(column_pairs(f), f.part_x.data()),
        rows_(words_of(f.row.data()), f.part_y.data()) {}

  HWY_ATTR HWY_INLINE Taps at(FixedPx x, FixedPx y) const {
    const int left = whole(x) + f_.least_column;
    const auto y16 = static_cast<std::int32_t>(y >> 16);
    const int top = (y16 + f_.least_y) >> 16, bottom = (y16 + f_.greatest_y) >> 16;
    Wide columns = columns_.at(x, 0x101);
    if (room_ < 0) return of_narrow(left, top, bottom, columns, y);
    int first = left;
    if (left < 0 || left > room_) {
      first = std::clamp(left, 0, room_);
      columns = onto_edge(columns, left - first);
    }
    Taps taps{row_at(top, first, columns), row_at(top + 1, first, columns)};
    if (top == bottom) return taps;
    const Wide rows = rows_.at(y, 1);
    const int base = whole(y) + f_.least_row;
    Wide row = taps.lower;
    for (int r = top + 1; r <= bottom; ++r) {
      const Wide next = row_at(r + 1, first, columns);
      choose(rows, r - base, row, next, taps);
      row = next;
    }
    return taps;
  }

 private:
  // Columns from a first one `shift` farther right, in a picture that ends with the pixels loaded (shift > 0)
  // or begins with them: those beyond it are moved onto its edge.
  HWY_ATTR HWY_INLINE Wide onto_edge(Wide columns, int shift) const {
    const __m512i by = _mm512_set1_epi8(static_cast<char>(std::clamp(shift, -128, 127)));
    const __m512i low = _mm512_add_epi8(columns.low, by), high = _mm512_add_epi8(columns.high, by);
    if (shift < 0) {
      const __m512i zero = _mm512_setzero_si512();
      return {_mm512_max_epi8(low, zero), _mm512_max_epi8(high, zero)};
    }
    const __m512i most = _mm512_set1_epi8(static_cast<char>(reach_ - 1));
    return {_mm512_min_epu8(low, most), _mm512_min_epu8(high, most)};
  }
  // The taps of lanes whose upper row is `here`.
  HWY_ATTR static HWY_INLINE void choose(Wide rows, int here, Wide upper, Wide lower, Taps& taps) {
    const __m512i row = _mm512_set1_epi16(static_cast<short>(here));
    const __mmask32 low = _mm512_cmpeq_epi16_mask(rows.low, row);
    const __mmask32 high = _mm512_cmpeq_epi16_mask(rows.high, row);
    taps.upper.low = _mm512_mask_mov_epi16(taps.upper.low, low, upper.low);
    taps.upper.high = _mm512_mask_mov_epi16(taps.upper.high, high, upper.high);
    taps.lower.low = _mm512_mask_mov_epi16(taps.lower.low, low, lower.low);
    taps.lower.high = _mm512_mask_mov_epi16(taps.lower.high, high, lower.high);
  }
  HWY_ATTR HWY_INLINE Wide row_at(int r, int column, Wide columns) const {
    const std::uint8_t* from = f_.pixels + std::clamp(r, 0, f_.height - 1) * f_.stride + column;
    const __m512i first = _mm512_loadu_si512(from);
    const __m512i second =
        reach_ == 80 ? _mm512_castsi128_si512(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + 64)))
                     : _mm512_loadu_si512(from + 64);
    return {_mm512_permutex2var_epi8(first, columns.low, second),
            _mm512_permutex2var_epi8(first, columns.high, second)};
  }

  // A picture with fewer columns than are loaded.
  HWY_ATTR HWY_NOINLINE Taps of_narrow(int left, int top, int bottom, Wide columns, FixedPx y) const {
    const int least = std::clamp(-left, 0, 127), most = std::clamp(f_.width - 1 - left, 0, 127);
    columns = clamped(columns, 0, least, most);
    const __mmask64 low = in_picture(left), high = in_picture(left + 64);
    const auto row_at = [&](int r) HWY_ATTR {
      const std::uint8_t* from = f_.pixels + std::clamp(r, 0, f_.height - 1) * f_.stride + left;
      const __m512i first = _mm512_maskz_loadu_epi8(low, from);
      const __m512i second = _mm512_maskz_loadu_epi8(high, from + 64);
      return Wide{_mm512_permutex2var_epi8(first, columns.low, second),
                  _mm512_permutex2var_epi8(first, columns.high, second)};
    };
    Taps taps{row_at(top), row_at(top + 1)};
    const Wide rows = rows_.at(y, 1);
    const int base = whole(y) + f_.least_row;
    for (int r = top + 1; r <= bottom; ++r) choose(rows, r - base, row_at(r), row_at(r + 1), taps);
    return taps;
  }
  HWY_ATTR HWY_INLINE __mmask64 in_picture(int left) const {
    const int skip = std::clamp(-left, 0, 64), take = std::clamp(f_.width - left, 0, 64);
    if (take <= skip) return 0;
    return (~LaneMask{0} >> (64 - (take - skip))) << skip;
  }

  const PatchFrame& f_;
  int reach_;  // columns loaded
  int room_;   // greatest first column
  Whole columns_, rows_;
};

// Lanes within 16 x 16 pixels, which stay in four registers while the layers move within them.
class WindowTaps {
 public:
  HWY_ATTR WindowTaps(const PatchFrame& f, bool forward_x, bool forward_y)
      : f_(f),
        columns_(indices(f), f.part_x.data()),
        rows_(row_pairs(f), f.part_y.data()),
        forward_x_(forward_x),
        forward_y_(forward_y) {
    for (__m512i& w : window_) w = _mm512_setzero_si512();
  }

  HWY_ATTR HWY_INLINE Taps at(FixedPx x, FixedPx y) {
    const int left = whole(x) + f_.least_column, top = whole(y) + f_.least_row;
    if (!holds(left, top)) {
      move(left, top);
      if (!holds(left, top)) return at_edge(x, y, left - left_, top - top_);
    }
    const __m512i shift = _mm512_set1_epi8(static_cast<char>(left - left_ + 16 * (top - top_)));
    const Wide upper = rows_.add_carries(columns_.at(x, 0x101), y, 0x1010);
    const Wide at{_mm512_add_epi8(upper.low, shift), _mm512_add_epi8(upper.high, shift)};
    const __m512i row = _mm512_set1_epi8(16);
    return {{pixels(at.low), pixels(at.high)},
            {pixels(_mm512_add_epi8(at.low, row)), pixels(_mm512_add_epi8(at.high, row))}};
  }

 private:
  HWY_ATTR static HWY_INLINE Wide indices(const PatchFrame& f) {
    const Wide columns = column_pairs(f), rows = row_pairs(f);
    return {_mm512_add_epi16(columns.low, _mm512_slli_epi16(rows.low, 4)),
            _mm512_add_epi16(columns.high, _mm512_slli_epi16(rows.high, 4))};
  }
  // All taps, with a carry and one more.
  HWY_ATTR HWY_INLINE bool holds(int left, int top) const {
    return static_cast<unsigned>(left - left_) <= static_cast<unsigned>(13 - f_.columns) &&
           static_cast<unsigned>(top - top_) <= static_cast<unsigned>(13 - f_.rows);
  }
  HWY_ATTR HWY_INLINE __m512i pixels(__m512i index) const {
    const __m512i upper = _mm512_permutex2var_epi8(window_[0], index, window_[1]);
    const __m512i lower = _mm512_permutex2var_epi8(window_[2], index, window_[3]);
    return _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower);
  }
  HWY_ATTR HWY_NOINLINE Taps at_edge(FixedPx x, FixedPx y, int shift_x, int shift_y) const {
    const Whole column(column_pairs(f_), f_.part_x.data());
    const Wide columns = clamped(column.at(x, 0x101), shift_x, 0, 15);
    const Wide row = rows_.at(y, 0x101);
    const auto pixels_of = [&](Wide rows) HWY_ATTR {
      return Wide{pixels(_mm512_or_si512(_mm512_slli_epi16(rows.low, 4), columns.low)),
                  pixels(_mm512_or_si512(_mm512_slli_epi16(rows.high, 4), columns.high))};
    };
    return {pixels_of(clamped(row, shift_y, 0, 15)), pixels_of(clamped(row, shift_y + 1, 0, 15))};
  }
  HWY_ATTR HWY_INLINE void move(int left, int top) {
    const int x = std::clamp(forward_x_ ? left : left - (13 - f_.columns), 0, f_.width - 16);
    const int y = std::clamp(forward_y_ ? top : top - (13 - f_.rows), 0, f_.height - 16);
    if (x == left_ && y == top_) return;
    left_ = x;
    top_ = y;
    load_rows(f_.pixels + top_ * f_.stride + left_, f_.stride, 4, window_);
  }

  const PatchFrame& f_;
  Whole columns_;  // in the lower four bits; rows in the upper
  Whole rows_;
  __m512i window_[4];
  int left_ = 1 << 24, top_ = 1 << 24;  // of the window; far from any picture at first
  bool forward_x_, forward_y_;          // the way the layers move
};

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

// Lanes all of whose taps are not 0.
HWY_ATTR HWY_INLINE LaneMask all_set(const Taps& t) {
  const auto half = [](__m512i upper, __m512i lower) HWY_ATTR {
    const __m512i least = _mm512_min_epu8(upper, lower);
    const __m512i pair = _mm512_min_epu8(least, _mm512_srli_epi16(least, 8));
    return static_cast<LaneMask>(_mm512_test_epi16_mask(pair, _mm512_set1_epi16(0xff)));
  };
  return half(t.upper.low, t.lower.low) | half(t.upper.high, t.lower.high) << 32;
}

template <class FetchTaps>
HWY_ATTR void taps_inside_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers,
                                   LaneMask* masks) {
  FetchTaps fetch(f, layers < 2 || x[1] >= x[0], layers < 2 || y[1] >= y[0]);
  for (int l = 0; l < layers; ++l) {
    if (masks[l] != 0) masks[l] &= all_set(fetch.at(x[l], y[l]));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
