// Turning a part of a picture, so that its columns become rows. Included once per target.
// clang-format off
#if defined(SONOBAND_PATCH_TURN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_TURN_INL_H
#undef SONOBAND_PATCH_TURN_INL_H
#else
#define SONOBAND_PATCH_TURN_INL_H
#endif
// clang-format on

#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "core/reslice/patch.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int turned_side = least_turned_px;  // of the squares that are turned in registers

// Square of pixels, rows `from`, to columns: column i goes to to[i], where that is not null.
HWY_ATTR HWY_INLINE void turn_square(const std::uint8_t* const* from, std::uint8_t* const* to) {
// SVE's vectors go into no array, of known length or not.
#if HWY_TARGET == HWY_SCALAR || (HWY_TARGET & (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)) != 0
  for (int i = 0; i < turned_side; ++i)
    for (int j = 0; to[i] != nullptr && j < turned_side; ++j) to[i][j] = from[j][i];
#elif HWY_TARGET == HWY_AVX3_DL
  const auto row = [&](int i) HWY_ATTR { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from[i])); };
  const auto four = [&](int i) HWY_ATTR {
    const __m256i upper = _mm256_inserti128_si256(_mm256_castsi128_si256(row(i)), row(i + 1), 1);
    const __m256i lower = _mm256_inserti128_si256(_mm256_castsi128_si256(row(i + 2)), row(i + 3), 1);
    return _mm512_inserti64x4(_mm512_castsi256_si512(upper), lower, 1);
  };
  const __m512i a = four(0), b = four(4), c = four(8), d = four(12);
  // Of a and b byte 16 r + column, for rows 0 .. 7 twice: of the first column, of the second and so on.
  const __m512i rows = _mm512_set1_epi64(0x7060504030201000);
  const __m512i columns = _mm512_set_epi64(0x0303030303030303, 0x0303030303030303, 0x0202020202020202,
                                           0x0202020202020202, 0x0101010101010101, 0x0101010101010101, 0, 0);
  constexpr __mmask64 lower_rows = 0xff00ff00ff00ff00;
  for (int i = 0; i < turned_side; i += 4) {
    const __m512i at =
        _mm512_add_epi8(_mm512_add_epi8(rows, columns), _mm512_set1_epi8(static_cast<char>(i)));
    const __m512i turned = _mm512_mask_mov_epi8(_mm512_permutex2var_epi8(a, at, b), lower_rows,
                                                _mm512_permutex2var_epi8(c, at, d));
    const auto put = [&](int k, __m128i column) HWY_ATTR {
      if (to[i + k] != nullptr) _mm_storeu_si128(reinterpret_cast<__m128i*>(to[i + k]), column);
    };
    put(0, _mm512_castsi512_si128(turned));
    put(1, _mm512_extracti32x4_epi32(turned, 1));
    put(2, _mm512_extracti32x4_epi32(turned, 2));
    put(3, _mm512_extracti32x4_epi32(turned, 3));
  }
#else
  const hn::Full128<std::uint8_t> d;
  using Row = hn::Vec<hn::Full128<std::uint8_t>>;
  Row rows[turned_side], mixed[turned_side];
  for (int i = 0; i < turned_side; ++i) rows[i] = hn::LoadU(d, from[i]);
  // Four perfect shuffles of 16 rows.
  for (int round = 0; round < 4; ++round) {
    for (int i = 0; i < turned_side / 2; ++i) {
      mixed[2 * i] = hn::InterleaveLower(d, rows[i], rows[i + turned_side / 2]);
      mixed[2 * i + 1] = hn::InterleaveUpper(d, rows[i], rows[i + turned_side / 2]);
    }
    for (int i = 0; i < turned_side; ++i) rows[i] = mixed[i];
  }
  for (int i = 0; i < turned_side; ++i)
    if (to[i] != nullptr) hn::StoreU(rows[i], d, to[i]);
#endif
}

HWY_ATTR inline void turn(const PictureRows& picture, int left, int top, int columns, int rows,
                          std::uint8_t* to, std::ptrdiff_t to_stride) {
  if (left >= picture.width || left + columns <= 0) return;
  const int first = std::clamp(left, 0, picture.width - 1);
  const int last = std::clamp(left + columns - 1, 0, picture.width - 1);
  const std::uint8_t* from[turned_side];
  std::uint8_t* columns_to[turned_side];
  for (int y = 0; y < rows; y += turned_side) {
    for (int x = first; x <= last; x += turned_side) {
      const int start = std::min(x, picture.width - turned_side);
      for (int i = 0; i < turned_side; ++i) {
        from[i] = picture.pixels + std::clamp(top + y + i, 0, picture.height - 1) * picture.stride + start;
        const int column = start + i - left;
        columns_to[i] = column >= 0 && column < columns ? to + column * to_stride + y : nullptr;
      }
      turn_square(from, columns_to);
    }
  }
  const auto copy = [&](int column, int x) {
    if (column != x) std::memcpy(to + (column - left) * to_stride, to + (x - left) * to_stride, to_stride);
  };
  for (int x = left; x < first; ++x) copy(x, first);
  for (int x = last + 1; x < left + columns; ++x) copy(x, last);
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
