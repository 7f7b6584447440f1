// Fetching by byte permutes: 64 pixels out of 128 in one instruction (AVX-512 VBMI), where Highway 1.0 has
// none. Included once per target that has it.
//
// The pixel of lane k is the whole part of position + offset. With both split into whole and 16-bit
// fractional parts it is whole + whole, plus 1 where the fractions carry: one compare of 16-bit numbers
// instead of sums of wide ones.
// clang-format off
#if defined(SONOBAND_PATCH_FETCH_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_FETCH_VBMI_INL_H
#undef SONOBAND_PATCH_FETCH_VBMI_INL_H
#else
#define SONOBAND_PATCH_FETCH_VBMI_INL_H
#endif
// clang-format on

#include <hwy/highway.h>
#include <immintrin.h>

#include <algorithm>

#include "core/reslice/patch.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Where the fractional parts of 64 lanes carry when that of a position is added.
struct Carries {
  __m512i low, high;
  HWY_ATTR explicit Carries(const std::uint16_t* parts)
      : low(_mm512_load_si512(parts)), high(_mm512_load_si512(parts + 32)) {}
  HWY_ATTR HWY_INLINE __mmask64 at(FixedPx position) const {
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
  HWY_ATTR RowsFetch(const PatchFrame& f, bool, bool)
      : pixels_(f.pixels),
        stride_(f.stride),
        width_(f.width),
        height_(f.height),
        least_column_(f.least_column),
        least_row_(f.least_row),
        least_y_(f.least_y),
        greatest_y_(f.greatest_y),
        reach_(f.columns + 1 < 80 ? 80 : 128),
        room_(f.width - reach_),
        carries_x_(f.part_x.data()),
        carries_y_(f.part_y.data()),
        column_(_mm512_load_si512(f.column.data())),
        row_(_mm512_load_si512(f.row.data())) {}

  HWY_ATTR HWY_INLINE __m512i at(FixedPx x, FixedPx y) const {
    const int left = whole(x) + least_column_;
    const int base = whole(y) + least_row_;
    const auto y16 = static_cast<std::int32_t>(y >> 16);
    const int top = (y16 + least_y_) >> 16, bottom = (y16 + greatest_y_) >> 16;
    const __m512i one = _mm512_set1_epi8(1);
    __m512i index = _mm512_mask_add_epi8(column_, carries_x_.at(x), column_, one);
    int from_column = left, first = top, last = bottom;
    if (left < 0 || left > room_ || top < 0 || bottom >= height_) {
      if (width_ < reach_) {
        // A copy, so that this one may stay in registers.
        const RowsFetch own = *this;
        return own.at_edge(left, base, top, bottom, index, y);
      }
      // Within the picture; lanes beyond it get any value.
      from_column = std::clamp(left, 0, room_);
      index = _mm512_add_epi8(index, _mm512_set1_epi8(static_cast<char>(left - from_column)));
      first = std::max(top, 0);
      last = std::min(bottom, height_ - 1);
      if (first > last) return index;
    }
    const std::uint8_t* from = pixels_ + first * stride_ + from_column;
    __m512i values = permuted(from, index);
    if (first == last) return values;
    const __m512i row = _mm512_mask_add_epi8(row_, carries_y_.at(y), row_, one);
    for (int r = first + 1; r <= last; ++r) {
      from += stride_;
      const __mmask64 here = _mm512_cmpeq_epi8_mask(row, _mm512_set1_epi8(static_cast<char>(r - base)));
      values = _mm512_mask_mov_epi8(values, here, permuted(from, index));
    }
    return values;
  }

  // Asks for the pixels of a layer to come.
  HWY_ATTR HWY_INLINE void prefetch(FixedPx x, FixedPx y) const {
    const std::uint8_t* from = pixels_ + (whole(y) + least_row_) * stride_ + whole(x) + least_column_;
    _mm_prefetch(reinterpret_cast<const char*>(from), _MM_HINT_T0);
    _mm_prefetch(reinterpret_cast<const char*>(from + 64), _MM_HINT_T0);
  }

 private:
  HWY_ATTR HWY_INLINE __m512i permuted(const std::uint8_t* from, __m512i index) const {
    // Lanes rarely span more than a few pixels beyond 64: that saves a cache line.
    const __m512i high =
        reach_ == 80 ? _mm512_castsi128_si512(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + 64)))
                     : _mm512_loadu_si512(from + 64);
    return _mm512_permutex2var_epi8(_mm512_loadu_si512(from), index, high);
  }

  HWY_ATTR HWY_NOINLINE __m512i at_edge(int left, int base, int top, int bottom, __m512i index,
                                        FixedPx y) const {
    const __m512i row = _mm512_mask_add_epi8(row_, carries_y_.at(y), row_, _mm512_set1_epi8(1));
    const __mmask64 low = in_picture(left), high = in_picture(left + 64);
    __m512i values = _mm512_setzero_si512();
    for (int r = std::max(top, 0); r <= std::min(bottom, height_ - 1); ++r) {
      const std::uint8_t* from = pixels_ + r * stride_ + left;
      const __mmask64 here = _mm512_cmpeq_epi8_mask(row, _mm512_set1_epi8(static_cast<char>(r - base)));
      values = _mm512_mask_mov_epi8(values, here,
                                    _mm512_permutex2var_epi8(_mm512_maskz_loadu_epi8(low, from), index,
                                                             _mm512_maskz_loadu_epi8(high, from + 64)));
    }
    return values;
  }
  // Of 64 columns from `left`, those of the picture.
  HWY_ATTR __mmask64 in_picture(int left) const {
    const int skip = std::clamp(-left, 0, 64), take = std::clamp(width_ - left, 0, 64);
    if (take <= skip) return 0;
    return (~LaneMask{0} >> (64 - (take - skip))) << skip;
  }

  const std::uint8_t* pixels_;
  std::ptrdiff_t stride_;
  int width_, height_, least_column_, least_row_;
  std::int32_t least_y_, greatest_y_;
  int reach_;  // columns loaded
  int room_;   // greatest first column
  Carries carries_x_, carries_y_;
  __m512i column_, row_;
};

// Four rows of 16 pixels into a register.
HWY_ATTR HWY_INLINE __m512i load_quarter(const std::uint8_t* from, std::ptrdiff_t stride) {
  const auto sixteen = [](const std::uint8_t* row)
                           HWY_ATTR { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row)); };
  // Two pairs, so that neither waits for the other.
  const __m256i upper =
      _mm256_inserti128_si256(_mm256_castsi128_si256(sixteen(from)), sixteen(from + stride), 1);
  const __m256i lower = _mm256_inserti128_si256(_mm256_castsi128_si256(sixteen(from + 2 * stride)),
                                                sixteen(from + 3 * stride), 1);
  return _mm512_inserti64x4(_mm512_castsi256_si512(upper), lower, 1);
}

// 16 x 4 quarters pixels into as many registers.
HWY_ATTR HWY_INLINE void load_rows(const std::uint8_t* from, std::ptrdiff_t stride, int quarters,
                                   __m512i* window) {
  window[0] = load_quarter(from, stride);
  if (quarters > 1) window[1] = load_quarter(from + 4 * stride, stride);
  if (quarters > 2) window[2] = load_quarter(from + 8 * stride, stride);
  if (quarters > 3) window[3] = load_quarter(from + 12 * stride, stride);
}

// Lanes within 16 x 16 pixels, which stay in four registers while the layers move within them.
class WindowFetch {
 public:
  // The way x and y move from layer to layer.
  HWY_ATTR WindowFetch(const PatchFrame& f, bool forward_x, bool forward_y)
      : pixels_(f.pixels),
        stride_(f.stride),
        width_(f.width),
        height_(f.height),
        least_column_(f.least_column),
        least_row_(f.least_row),
        room_x_(static_cast<unsigned>(14 - f.columns)),
        room_y_(static_cast<unsigned>(14 - f.rows)),
        carries_x_(f.part_x.data()),
        carries_y_(f.part_y.data()),
        index_(_mm512_or_si512(_mm512_load_si512(f.column.data()),
                               _mm512_slli_epi16(_mm512_load_si512(f.row.data()), 4))),
        forward_x_(forward_x),
        forward_y_(forward_y) {
    for (__m512i& w : window_) w = _mm512_setzero_si512();
  }

  HWY_ATTR HWY_INLINE __m512i at(FixedPx x, FixedPx y) {
    const int left = whole(x) + least_column_, top = whole(y) + least_row_;
    // One comparison for each axis: by how far the lanes start within the window.
    if (static_cast<unsigned>(left - left_) > room_x_ || static_cast<unsigned>(top - top_) > room_y_) {
      move(left, top);
    }
    __m512i index =
        _mm512_add_epi8(index_, _mm512_set1_epi8(static_cast<char>(left - left_ + 16 * (top - top_))));
    index = _mm512_mask_add_epi8(index, carries_x_.at(x), index, _mm512_set1_epi8(1));
    index = _mm512_mask_add_epi8(index, carries_y_.at(y), index, _mm512_set1_epi8(16));
    const __m512i upper = _mm512_permutex2var_epi8(window_[0], index, window_[1]);
    const __m512i lower = _mm512_permutex2var_epi8(window_[2], index, window_[3]);
    return _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower);
  }

  HWY_ATTR HWY_INLINE void prefetch(FixedPx, FixedPx) const {}

 private:
  // Puts the window where the lanes are and will be, within the picture. Lanes beyond it stay beyond it.
  HWY_ATTR HWY_INLINE void move(int left, int top) {
    const int x = std::clamp(forward_x_ ? left : left - static_cast<int>(room_x_), 0, width_ - 16);
    const int y = std::clamp(forward_y_ ? top : top - static_cast<int>(room_y_), 0, height_ - 16);
    if (x == left_ && y == top_) return;
    left_ = x;
    top_ = y;
    load_rows(pixels_ + top_ * stride_ + left_, stride_, 4, window_);
  }

  const std::uint8_t* pixels_;
  std::ptrdiff_t stride_;
  int width_, height_, least_column_, least_row_;
  unsigned room_x_, room_y_;  // by which the lanes may move within the window
  Carries carries_x_, carries_y_;
  __m512i index_;
  __m512i window_[4];
  int left_ = 1 << 24, top_ = 1 << 24;  // of the window; far from any picture at first
  bool forward_x_, forward_y_;          // the way the layers move
};

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
