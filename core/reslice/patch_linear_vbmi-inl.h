// Blending bilinear samples by byte permutes (AVX-512 VBMI): four taps of 64 lanes at once, weights of 16
// bits. Included once per target that has it.
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

struct Taps {
  __m512i upper_left, upper_right, lower_left, lower_right;  // bytes by lane
};

// Columns or rows of the two taps along one axis, relative to a first one, moved into [least, most].
struct TapPair {
  __m512i first, second;
  HWY_ATTR HWY_INLINE TapPair(__m512i at, int least, int most) {
    const __m512i low = _mm512_set1_epi8(static_cast<char>(least));
    const __m512i high = _mm512_set1_epi8(static_cast<char>(most));
    first = _mm512_min_epi8(_mm512_max_epi8(at, low), high);
    second = _mm512_min_epi8(_mm512_max_epi8(_mm512_add_epi8(at, _mm512_set1_epi8(1)), low), high);
  }
};

class TapsBase {
 public:
  HWY_ATTR explicit TapsBase(const PatchFrame& f)
      : f_(f),
        carries_x_(f.part_x.data()),
        carries_y_(f.part_y.data()),
        column_(_mm512_load_si512(f.column.data())),
        row_(_mm512_load_si512(f.row.data())) {}

 protected:
  HWY_ATTR HWY_INLINE __m512i column(FixedPx x, int shift) const {
    const __m512i at = _mm512_mask_add_epi8(column_, carries_x_.at(x), column_, _mm512_set1_epi8(1));
    return _mm512_add_epi8(at, _mm512_set1_epi8(static_cast<char>(shift)));
  }
  HWY_ATTR HWY_INLINE __m512i row(FixedPx y, int shift) const {
    const __m512i at = _mm512_mask_add_epi8(row_, carries_y_.at(y), row_, _mm512_set1_epi8(1));
    return _mm512_add_epi8(at, _mm512_set1_epi8(static_cast<char>(shift)));
  }
  const PatchFrame& f_;
  Carries carries_x_, carries_y_;
  __m512i column_, row_;
};

class RowsTaps : TapsBase {
 public:
  HWY_ATTR RowsTaps(const PatchFrame& f, bool, bool) : TapsBase(f) {}

  HWY_ATTR HWY_INLINE Taps at(FixedPx x, FixedPx y) {
    const int left = whole(x) + f_.least_column, top = whole(y) + f_.least_row;
    const auto edge = [](int first, int size, int& least, int& most) {
      least = std::clamp(-first, 0, 127);
      most = std::clamp(size - 1 - first, 0, 127);
    };
    int least_column = 0, most_column = 0, least_row = 0, most_row = 0;
    edge(left, f_.width, least_column, most_column);
    edge(top, f_.height, least_row, most_row);
    const TapPair columns(column(x, 0), least_column, most_column);
    const TapPair rows(row(y, 0), least_row, most_row);
    const bool clear = left >= 0 && left + 128 <= f_.width;
    const __mmask64 low = clear ? ~LaneMask{0} : in_picture(left);
    const __mmask64 high = clear ? ~LaneMask{0} : in_picture(left + 64);
    Taps taps{};
    const int last = std::min(most_row, f_.rows + 2);
    for (int r = least_row; r <= last; ++r) {
      if (top + r < 0 || top + r >= f_.height) continue;
      const std::uint8_t* from = f_.pixels + (top + r) * f_.stride + left;
      const __m512i a = _mm512_maskz_loadu_epi8(low, from), b = _mm512_maskz_loadu_epi8(high, from + 64);
      const __m512i on_left = _mm512_permutex2var_epi8(a, columns.first, b);
      const __m512i on_right = _mm512_permutex2var_epi8(a, columns.second, b);
      const __m512i this_row = _mm512_set1_epi8(static_cast<char>(r));
      const __mmask64 upper = _mm512_cmpeq_epi8_mask(rows.first, this_row);
      const __mmask64 lower = _mm512_cmpeq_epi8_mask(rows.second, this_row);
      taps.upper_left = _mm512_mask_mov_epi8(taps.upper_left, upper, on_left);
      taps.upper_right = _mm512_mask_mov_epi8(taps.upper_right, upper, on_right);
      taps.lower_left = _mm512_mask_mov_epi8(taps.lower_left, lower, on_left);
      taps.lower_right = _mm512_mask_mov_epi8(taps.lower_right, lower, on_right);
    }
    return taps;
  }

 private:
  HWY_ATTR HWY_INLINE __mmask64 in_picture(int left) const {
    const int skip = std::clamp(-left, 0, 64), take = std::clamp(f_.width - left, 0, 64);
    if (take <= skip) return 0;
    return (~LaneMask{0} >> (64 - (take - skip))) << skip;
  }
};

class WindowTaps : TapsBase {
 public:
  HWY_ATTR WindowTaps(const PatchFrame& f, bool forward_x, bool forward_y)
      : TapsBase(f), forward_x_(forward_x), forward_y_(forward_y) {
    for (__m512i& w : window_) w = _mm512_setzero_si512();
  }

  HWY_ATTR HWY_INLINE Taps at(FixedPx x, FixedPx y) {
    const int left = whole(x) + f_.least_column, top = whole(y) + f_.least_row;
    const int room_x = 13 - f_.columns, room_y = 13 - f_.rows;
    if (left < left_ || left > left_ + room_x || top < top_ || top > top_ + room_y)
      move(left, top, room_x, room_y);
    const TapPair columns(column(x, left - left_), 0, 15);
    const TapPair rows(row(y, top - top_), 0, 15);
    const __m512i upper = _mm512_slli_epi16(rows.first, 4), lower = _mm512_slli_epi16(rows.second, 4);
    return {pixel(upper, columns.first), pixel(upper, columns.second), pixel(lower, columns.first),
            pixel(lower, columns.second)};
  }

 private:
  HWY_ATTR HWY_INLINE __m512i pixel(__m512i row, __m512i column) const {
    const __m512i index = _mm512_or_si512(row, column);
    const __m512i upper = _mm512_permutex2var_epi8(window_[0], index, window_[1]);
    const __m512i lower = _mm512_permutex2var_epi8(window_[2], index, window_[3]);
    return _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower);
  }
  HWY_ATTR HWY_INLINE void move(int left, int top, int room_x, int room_y) {
    const int x = std::clamp(forward_x_ ? left : left - room_x, 0, f_.width - 16);
    const int y = std::clamp(forward_y_ ? top : top - room_y, 0, f_.height - 16);
    if (x == left_ && y == top_) return;
    left_ = x;
    top_ = y;
    load_rows(f_.pixels + top_ * f_.stride + left_, f_.stride, 4, window_);
  }

  __m512i window_[4];
  int left_ = 1 << 24, top_ = 1 << 24;  // of the window; far from any picture at first
  bool forward_x_, forward_y_;          // the way the layers move
};

// 64 numbers of 16 bits in the order bytes have after widening by unpacking: halves of each 16 lanes.
struct Wide {
  __m512i low, high;
};
HWY_ATTR HWY_INLINE Wide widened_to_high_bytes(__m512i bytes) {  // times 256
  const __m512i zero = _mm512_setzero_si512();
  return {_mm512_unpacklo_epi8(zero, bytes), _mm512_unpackhi_epi8(zero, bytes)};
}
// 64 words in lane order to that order.
HWY_ATTR inline Wide words_unpacked(const std::uint16_t* words) {
  alignas(64) std::uint16_t low[32], high[32];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 8; ++j) {
      low[8 * i + j] = words[16 * i + j];
      high[8 * i + j] = words[16 * i + 8 + j];
    }
  }
  return {_mm512_load_si512(low), _mm512_load_si512(high)};
}

HWY_ATTR HWY_INLINE __m512i lerp_words(__m512i a, __m512i b, __m512i t) {
  const __m512i rest = _mm512_xor_si512(t, _mm512_set1_epi16(-1));
  return _mm512_add_epi16(_mm512_mulhi_epu16(a, rest), _mm512_mulhi_epu16(b, t));
}

// A frame's bilinear values in 1/256 level.
template <class FetchTaps>
class Bilinear {
 public:
  HWY_ATTR Bilinear(const LinearSide& side, int layers)
      : taps_(*side.frame, layers < 2 || side.x[1] >= side.x[0], layers < 2 || side.y[1] >= side.y[0]),
        part_x_(words_unpacked(side.frame->part_x.data())),
        part_y_(words_unpacked(side.frame->part_y.data())) {}

  HWY_ATTR HWY_INLINE Wide at(FixedPx x, FixedPx y) {
    const Taps t = taps_.at(x, y);
    const Wide ul = widened_to_high_bytes(t.upper_left), ur = widened_to_high_bytes(t.upper_right);
    const Wide ll = widened_to_high_bytes(t.lower_left), lr = widened_to_high_bytes(t.lower_right);
    const __m512i add_x = _mm512_set1_epi16(static_cast<short>(x >> 16));
    const __m512i add_y = _mm512_set1_epi16(static_cast<short>(y >> 16));
    const auto half = [&](__m512i a, __m512i b, __m512i c, __m512i d, __m512i px, __m512i py) HWY_ATTR {
      const __m512i tx = _mm512_add_epi16(px, add_x), ty = _mm512_add_epi16(py, add_y);
      return lerp_words(lerp_words(a, b, tx), lerp_words(c, d, tx), ty);
    };
    return {half(ul.low, ur.low, ll.low, lr.low, part_x_.low, part_y_.low),
            half(ul.high, ur.high, ll.high, lr.high, part_x_.high, part_y_.high)};
  }

 private:
  FetchTaps taps_;
  Wide part_x_, part_y_;
};

// Weights of the second frame, |za| / (|za| + |zb|) in 1/65536, in the order of Wide.
class DistanceShare {
 public:
  HWY_ATTR DistanceShare(const LaneGrid& grid, const LinearSide& a, const LinearSide& b) {
    alignas(64) float za[patch_lanes], zb[patch_lanes];
    for (int q = 0; q < 4; ++q) {
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          const int k = 16 * i + 4 * q + j, to = 16 * q + 4 * i + j;
          za[to] = a.z_per_sample * grid.a[k] + a.z_per_row * grid.b[k];
          zb[to] = b.z_per_sample * grid.a[k] + b.z_per_row * grid.b[k];
        }
      }
    }
    for (int q = 0; q < 4; ++q) {
      za_[q] = _mm512_load_ps(za + 16 * q);
      zb_[q] = _mm512_load_ps(zb + 16 * q);
    }
  }
  HWY_ATTR HWY_INLINE Wide at(float za, float zb) const {
    const __m512 a = _mm512_set1_ps(za), b = _mm512_set1_ps(zb);
    __m512i share[4];
    for (int q = 0; q < 4; ++q) {
      const __m512 at_a = _mm512_add_ps(a, za_[q]), at_b = _mm512_add_ps(b, zb_[q]);
      const __m512 sum = _mm512_sub_ps(at_a, at_b);
      // One Newton step makes the 14 bits of the estimate a float's.
      const __m512 guess = _mm512_rcp14_ps(sum);
      const __m512 inverse =
          _mm512_mul_ps(guess, _mm512_sub_ps(_mm512_set1_ps(2.0F), _mm512_mul_ps(sum, guess)));
      const __m512 scaled = _mm512_mul_ps(_mm512_mul_ps(at_a, inverse), _mm512_set1_ps(65536.0F));
      share[q] = _mm512_cvtps_epi32(
          _mm512_min_ps(_mm512_max_ps(scaled, _mm512_setzero_ps()), _mm512_set1_ps(65535.0F)));
    }
    return {_mm512_packus_epi32(share[0], share[1]), _mm512_packus_epi32(share[2], share[3])};
  }

 private:
  __m512 za_[4], zb_[4];
};

template <Rule rule, class FetchA, class FetchB>
HWY_ATTR void blend_permuted(const LaneGrid& grid, const LinearSide& a, const LinearSide& b,
                             const LaneMask* masks, int layers, PatchSums& sums) {
  Bilinear<FetchA> of_a(a, layers);
  Bilinear<FetchB> of_b(b, layers);
  const DistanceShare share(grid, a, b);
  const __m512i rounding = _mm512_set1_epi16(static_cast<short>(blend_rounding));
  const __m512i one = _mm512_set1_epi8(1);
  __m512i count = _mm512_load_si512(sums.count.data());
  __m512i best = _mm512_load_si512(sums.extreme.data());
  WideSum sum(sums.sum.data());
  for (int l = 0; l < layers; ++l) {
    const __mmask64 m = masks[l];
    if (m == 0) continue;
    const Wide va = of_a.at(a.x[l], a.y[l]), vb = of_b.at(b.x[l], b.y[l]), w = share.at(a.z[l], b.z[l]);
    const auto rounded = [&](__m512i from_a, __m512i from_b, __m512i t) HWY_ATTR {
      return _mm512_srli_epi16(_mm512_adds_epu16(lerp_words(from_a, from_b, t), rounding), 8);
    };
    const __m512i v = _mm512_packus_epi16(rounded(va.low, vb.low, w.low), rounded(va.high, vb.high, w.high));
    count = _mm512_mask_add_epi8(count, m, count, one);
    if constexpr (rule == Rule::maximum) {
      best = _mm512_mask_max_epu8(best, m, best, v);
    } else if constexpr (rule == Rule::minimum) {
      best = _mm512_mask_min_epu8(best, m, best, v);
    } else {
      sum.add_unsigned(_mm512_maskz_mov_epi8(m, v));
    }
  }
  _mm512_store_si512(sums.count.data(), count);
  if constexpr (rule == Rule::mean_grey) {
    sum.store(sums.sum.data());
  } else {
    _mm512_store_si512(sums.extreme.data(), best);
  }
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

template <class FetchTaps>
HWY_ATTR void taps_inside_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers,
                                   LaneMask* masks) {
  FetchTaps fetch(f, layers < 2 || x[1] >= x[0], layers < 2 || y[1] >= y[0]);
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    const Taps t = fetch.at(x[l], y[l]);
    masks[l] &= _mm512_test_epi8_mask(t.upper_left, t.upper_left) &
                _mm512_test_epi8_mask(t.upper_right, t.upper_right) &
                _mm512_test_epi8_mask(t.lower_left, t.lower_left) &
                _mm512_test_epi8_mask(t.lower_right, t.lower_right);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
