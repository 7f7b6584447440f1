// Taps of bilinear samples by byte permutes (AVX-512 VBMI): the left and the right ones of 32 lanes at once,
// as pairs of bytes. Included once per target that has it.
// clang-format off
#if defined(SONOBAND_PATCH_TAPS_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_TAPS_VBMI_INL_H
#undef SONOBAND_PATCH_TAPS_VBMI_INL_H
#else
#define SONOBAND_PATCH_TAPS_VBMI_INL_H
#endif
// clang-format on

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
