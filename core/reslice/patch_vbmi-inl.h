// Fetching by byte permutes: 64 pixels out of 128 in one instruction (AVX-512 VBMI), where Highway 1.0 has
// none. Included once per target that has it.
//
// The pixel of lane k is the whole part of position + offset. With both split into whole and 16-bit
// fractional parts it is whole + whole, plus 1 where the fractions carry: one compare of 16-bit numbers
// instead of sums of wide ones.
// clang-format off
#if defined(SONOBAND_PATCH_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_VBMI_INL_H
#undef SONOBAND_PATCH_VBMI_INL_H
#else
#define SONOBAND_PATCH_VBMI_INL_H
#endif
// clang-format on

#include <hwy/highway.h>
#include <immintrin.h>

#include <algorithm>

#include "core/image/doppler.h"
#include "core/reslice/patch.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Where the fractional parts of 64 lanes carry when that of a position is added.
struct Carries {
  __m512i low, high;
  HWY_ATTR explicit Carries(const std::uint16_t* parts)
      : low(_mm512_load_si512(parts)), high(_mm512_load_si512(parts + 32)) {}
  HWY_ATTR __mmask64 at(FixedPx position) const {
    const __m512i most = _mm512_set1_epi16(static_cast<short>(~(position >> 16)));
    const __mmask32 l = _mm512_cmpgt_epu16_mask(low, most), h = _mm512_cmpgt_epu16_mask(high, most);
    return _mm512_kunpackd(h, l);
  }
};

inline int whole(FixedPx position) {
  return static_cast<int>(position >> 32);
}

// Lanes on few rows of the picture: each row's stretch is a table of 128 pixels.
class RowsFetch {
 public:
  HWY_ATTR RowsFetch(const PatchFrame& f, const FixedPx*, const FixedPx*, int)
      : f_(f),
        carries_x_(f.part_x.data()),
        carries_y_(f.part_y.data()),
        column_(_mm512_load_si512(f.column.data())),
        row_(_mm512_load_si512(f.row.data())) {}

  HWY_ATTR __m512i at(FixedPx x, FixedPx y) const {
    const int left = whole(x) + f_.least_column;
    const int base = whole(y) + f_.least_row;
    const auto y16 = static_cast<std::int32_t>(y >> 16);
    const int top = (y16 + f_.least_y) >> 16, bottom = (y16 + f_.greatest_y) >> 16;
    const __m512i one = _mm512_set1_epi8(1);
    const __m512i index = _mm512_mask_add_epi8(column_, carries_x_.at(x), column_, one);
    if (top == bottom) return top >= 0 && top < f_.height ? permuted(top, left, index) : column_;
    const __m512i row = _mm512_mask_add_epi8(row_, carries_y_.at(y), row_, one);
    __m512i values = column_;
    for (int r = std::max(top, 0); r <= std::min(bottom, f_.height - 1); ++r) {
      const __mmask64 here = _mm512_cmpeq_epi8_mask(row, _mm512_set1_epi8(static_cast<char>(r - base)));
      values = _mm512_mask_mov_epi8(values, here, permuted(r, left, index));
    }
    return values;
  }

 private:
  HWY_ATTR __m512i permuted(int row, int left, __m512i index) const {
    const std::uint8_t* from = f_.pixels + row * f_.stride + left;
    if (left >= 0 && left + 128 <= f_.width) {
      return _mm512_permutex2var_epi8(_mm512_loadu_si512(from), index, _mm512_loadu_si512(from + 64));
    }
    const __mmask64 low = in_picture(left), high = in_picture(left + 64);
    return _mm512_permutex2var_epi8(_mm512_maskz_loadu_epi8(low, from), index,
                                    _mm512_maskz_loadu_epi8(high, from + 64));
  }
  // Of 64 columns from `left`, those of the picture.
  HWY_ATTR __mmask64 in_picture(int left) const {
    const int skip = std::clamp(-left, 0, 64), take = std::clamp(f_.width - left, 0, 64);
    if (take <= skip) return 0;
    return (~LaneMask{0} >> (64 - (take - skip))) << skip;
  }

  const PatchFrame& f_;
  Carries carries_x_, carries_y_;
  __m512i column_, row_;
};

// Lanes within 16 x 16 pixels, which stay in four registers while the layers move within them.
class WindowFetch {
 public:
  HWY_ATTR WindowFetch(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers)
      : f_(f),
        carries_x_(f.part_x.data()),
        carries_y_(f.part_y.data()),
        index_(_mm512_or_si512(_mm512_load_si512(f.column.data()),
                               _mm512_slli_epi16(_mm512_load_si512(f.row.data()), 4))),
        forward_x_(layers < 2 || x[1] >= x[0]),
        forward_y_(layers < 2 || y[1] >= y[0]) {
    for (__m512i& w : window_) w = _mm512_setzero_si512();
  }

  HWY_ATTR __m512i at(FixedPx x, FixedPx y) {
    const int left = whole(x) + f_.least_column, top = whole(y) + f_.least_row;
    const int first_x = std::max(left, 0), last_x = std::min(left + f_.columns + 1, f_.width - 1);
    const int first_y = std::max(top, 0), last_y = std::min(top + f_.rows + 1, f_.height - 1);
    if (first_x < left_ || last_x > left_ + 15 || first_y < top_ || last_y > top_ + 15) {
      left_ = std::clamp(forward_x_ ? first_x : last_x - 15, 0, f_.width - 16);
      top_ = std::clamp(forward_y_ ? first_y : last_y - 15, 0, f_.height - 16);
      load();
    }
    __m512i index =
        _mm512_add_epi8(index_, _mm512_set1_epi8(static_cast<char>(left - left_ + 16 * (top - top_))));
    index = _mm512_mask_add_epi8(index, carries_x_.at(x), index, _mm512_set1_epi8(1));
    index = _mm512_mask_add_epi8(index, carries_y_.at(y), index, _mm512_set1_epi8(16));
    const __m512i upper = _mm512_permutex2var_epi8(window_[0], index, window_[1]);
    const __m512i lower = _mm512_permutex2var_epi8(window_[2], index, window_[3]);
    return _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower);
  }

 private:
  HWY_ATTR void load() {
    for (int i = 0; i < 4; ++i) {
      const std::uint8_t* row = f_.pixels + (top_ + 4 * i) * f_.stride + left_;
      const auto sixteen = [&](int r) HWY_ATTR {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + r * f_.stride));
      };
      __m512i w = _mm512_castsi128_si512(sixteen(0));
      w = _mm512_mask_broadcast_i32x4(w, 0x00f0, sixteen(1));
      w = _mm512_mask_broadcast_i32x4(w, 0x0f00, sixteen(2));
      window_[i] = _mm512_mask_broadcast_i32x4(w, 0xf000, sixteen(3));
    }
  }

  const PatchFrame& f_;
  Carries carries_x_, carries_y_;
  __m512i index_;
  __m512i window_[4];
  int left_ = 1 << 24, top_ = 1 << 24;  // of the window; far from any picture at first
  bool forward_x_, forward_y_;          // the way the layers move
};

// Two vectors of 16-bit lanes that add up bytes.
struct WideSum {
  __m512i low, high;
  HWY_ATTR explicit WideSum(const void* from)
      : low(_mm512_load_si512(from)), high(_mm512_load_si512(static_cast<const char*>(from) + 64)) {}
  HWY_ATTR void add_unsigned(__m512i bytes) {
    low = _mm512_add_epi16(low, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(bytes)));
    high = _mm512_add_epi16(high, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(bytes, 1)));
  }
  HWY_ATTR void add_signed(__m512i bytes) {
    low = _mm512_add_epi16(low, _mm512_cvtepi8_epi16(_mm512_castsi512_si256(bytes)));
    high = _mm512_add_epi16(high, _mm512_cvtepi8_epi16(_mm512_extracti64x4_epi64(bytes, 1)));
  }
  HWY_ATTR void store(void* to) const {
    _mm512_store_si512(to, low);
    _mm512_store_si512(static_cast<char*>(to) + 64, high);
  }
};

// Signed levels of the 128 coloured keys, for one permute.
struct VelocityTable {
  alignas(64) std::int8_t level[128];
  constexpr VelocityTable() : level() {
    for (int i = 0; i < 128; ++i)
      level[i] = static_cast<std::int8_t>(doppler::velocity(static_cast<std::uint8_t>(128 + i)));
  }
};
inline constexpr VelocityTable velocity_table;

template <Rule rule, class FetchLanes>
HWY_ATTR void take_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                            int layers, PatchSums& sums) {
  FetchLanes fetch(f, x, y, layers);
  const __m512i one = _mm512_set1_epi8(1);
  __m512i count = _mm512_load_si512(sums.count.data());
  if constexpr (rule == Rule::maximum || rule == Rule::minimum) {
    __m512i best = _mm512_load_si512(sums.extreme.data());
    for (int l = 0; l < layers; ++l) {
      const __mmask64 m = masks[l];
      if (m == 0) continue;
      const __m512i v = fetch.at(x[l], y[l]);
      best = rule == Rule::maximum ? _mm512_mask_max_epu8(best, m, best, v)
                                   : _mm512_mask_min_epu8(best, m, best, v);
      count = _mm512_mask_add_epi8(count, m, count, one);
    }
    _mm512_store_si512(sums.extreme.data(), best);
  } else if constexpr (rule == Rule::mean_grey) {
    WideSum sum(sums.sum.data());
    for (int l = 0; l < layers; ++l) {
      const __mmask64 m = masks[l];
      if (m == 0) continue;
      sum.add_unsigned(_mm512_maskz_mov_epi8(m, fetch.at(x[l], y[l])));
      count = _mm512_mask_add_epi8(count, m, count, one);
    }
    sum.store(sums.sum.data());
  } else {
    WideSum sum(sums.sum.data()), velocity(sums.velocity.data());
    __m512i coloured = _mm512_load_si512(sums.coloured.data());
    const __m512i table_low = _mm512_load_si512(velocity_table.level);
    const __m512i table_high = _mm512_load_si512(velocity_table.level + 64);
    for (int l = 0; l < layers; ++l) {
      const __mmask64 m = masks[l];
      if (m == 0) continue;
      const __m512i v = fetch.at(x[l], y[l]);
      const __mmask64 colour = m & _mm512_movepi8_mask(v);
      sum.add_unsigned(_mm512_maskz_mov_epi8(m & ~colour, v));
      count = _mm512_mask_add_epi8(count, m, count, one);
      if (colour == 0) continue;
      velocity.add_signed(_mm512_maskz_permutex2var_epi8(colour, table_low, v, table_high));
      coloured = _mm512_mask_add_epi8(coloured, colour, coloured, one);
    }
    sum.store(sums.sum.data());
    velocity.store(sums.velocity.data());
    _mm512_store_si512(sums.coloured.data(), coloured);
  }
  _mm512_store_si512(sums.count.data(), count);
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
