// The layers of a chain's cell in a patch, by byte permutes, where every pixel that is loaded is the
// picture's: nothing but the pixels' places changes from layer to layer. Included once per target that has
// them.
// clang-format off
#if defined(SONOBAND_PATCH_CELL_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_CELL_VBMI_INL_H
#undef SONOBAND_PATCH_CELL_VBMI_INL_H
#else
#define SONOBAND_PATCH_CELL_VBMI_INL_H
#endif
// clang-format on

#include <type_traits>

#include "core/reslice/chain_walk.h"
#include "core/reslice/patch_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Where lanes lie in a frame, from the pixel that least_row and least_column lead to, or so many columns
// before it.
struct LanePlaces {
  Carries carries_x, carries_y;
  __m512i column, row;
  const std::uint8_t* origin;  // of position 0
  std::ptrdiff_t stride;

  HWY_ATTR HWY_INLINE LanePlaces(const PatchFrame& f, int before)
      : carries_x(f.part_x.data()),
        carries_y(f.part_y.data()),
        column(
            _mm512_add_epi8(_mm512_load_si512(f.column.data()), _mm512_set1_epi8(static_cast<char>(before)))),
        row(_mm512_load_si512(f.row.data())),
        origin(f.pixels + f.least_row * f.stride + f.least_column - before),
        stride(f.stride) {}
  HWY_ATTR HWY_INLINE const std::uint8_t* at(FixedPx x, FixedPx y) const {
    return origin + (y >> 32) * stride + (x >> 32);
  }
  HWY_ATTR HWY_INLINE __m512i columns(FixedPx x) const {
    return _mm512_mask_add_epi8(column, carries_x.at(x), column, _mm512_set1_epi8(1));
  }
  HWY_ATTR HWY_INLINE __m512i rows(FixedPx y) const {
    return _mm512_mask_add_epi8(row, carries_y.at(y), row, _mm512_set1_epi8(1));
  }
};

// Positions of lane 0 between two.
struct PositionRange {
  FixedPx x, last_x, y, last_y;
  // In all layers of all patches of a group.
  PositionRange(const ChainFrame& f, const PatchGroup& group) : x(f.x), last_x(f.x), y(f.y), last_y(f.y) {
    const auto reach = [](FixedPx& least, FixedPx& greatest, FixedPx step, int from, int to) {
      least += std::min(from * step, to * step);
      greatest += std::max(from * step, to * step);
    };
    const PatchSite& site = group.sites[0];
    reach(x, last_x, f.x_per_sample, group.least_da, group.greatest_da);
    reach(x, last_x, f.x_per_row, group.least_db, group.greatest_db);
    reach(x, last_x, f.x_per_layer, site.first, site.depth - 1);
    reach(y, last_y, f.y_per_sample, group.least_da, group.greatest_da);
    reach(y, last_y, f.y_per_row, group.least_db, group.greatest_db);
    reach(y, last_y, f.y_per_layer, site.first, site.depth - 1);
  }
  // From layer to layer of a patch.
  PositionRange(const ChainFrame& f, const PatchSite& site, const LayerRange& range)
      : x(f.x_at(site, range.low)),
        last_x(x + (range.high - 1 - range.low) * f.x_per_layer),
        y(f.y_at(site, range.low)),
        last_y(y + (range.high - 1 - range.low) * f.y_per_layer) {}
};

// A table of so many columns and rows that holds all lanes is the picture's at all positions where it begins
// so many columns before the least one: 0 but near the picture's right edge. -1 where none is.
inline int columns_before(const PatchFrame& f, const PositionRange& at, int columns, int rows) {
  const int left = whole(std::min(at.x, at.last_x)) + f.least_column;
  const int before = std::max(0, whole(std::max(at.x, at.last_x)) + f.least_column + columns - f.width);
  const bool held = before + f.columns + 1 < columns && left >= before &&
                    whole(std::min(at.y, at.last_y)) + f.least_row >= 0 &&
                    whole(std::max(at.y, at.last_y)) + f.least_row + rows <= f.height;
  return held ? before : -1;
}

// Lanes on `count` pixel rows, `reach` columns of each.
template <int count, int reach>
struct InnerRows {
  LanePlaces places;
  HWY_ATTR HWY_INLINE InnerRows(const ChainFrame& f, int before) : places(*f.frame, before) {}
  static int before(const PatchFrame& f, const PositionRange& at) {
    return columns_before(f, at, reach, count);
  }
  HWY_ATTR HWY_INLINE __m512i at(FixedPx x, FixedPx y) const {
    const __m512i index = places.columns(x);
    const std::uint8_t* from = places.at(x, y);
    __m512i values = permuted(from, index);
    if constexpr (count > 1) {
      const __m512i row = places.rows(y);
      for (int r = 1; r < count; ++r) {
        from += places.stride;
        const __mmask64 here = _mm512_cmpeq_epi8_mask(row, _mm512_set1_epi8(static_cast<char>(r)));
        values = _mm512_mask_mov_epi8(values, here, permuted(from, index));
      }
    }
    return values;
  }
  HWY_ATTR HWY_INLINE static __m512i permuted(const std::uint8_t* from, __m512i index) {
    const __m512i low = _mm512_loadu_si512(from);
    if constexpr (reach == 64) return _mm512_permutexvar_epi8(index, low);
    if constexpr (reach == 80)
      return _mm512_permutex2var_epi8(
          low, index, _mm512_castsi128_si512(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + 64))));
    return _mm512_permutex2var_epi8(low, index, _mm512_loadu_si512(from + 64));
  }
};

// Lanes within 64 columns of two or four pixel rows.
template <int count>
struct InnerBlock {
  LanePlaces places;
  static int before(const PatchFrame& f, const PositionRange& at) { return columns_before(f, at, 64, count); }
  HWY_ATTR HWY_INLINE InnerBlock(const ChainFrame& f, int before) : places(*f.frame, before) {
    // The row is the index' upper two bits.
    places.column = _mm512_or_si512(places.column, _mm512_slli_epi16(places.row, 6));
  }
  HWY_ATTR HWY_INLINE __m512i at(FixedPx x, FixedPx y) const {
    __m512i index = places.columns(x);
    index = _mm512_mask_add_epi8(index, places.carries_y.at(y), index, _mm512_set1_epi8(64));
    const std::uint8_t* from = places.at(x, y);
    const std::ptrdiff_t stride = places.stride;
    const __m512i upper =
        _mm512_permutex2var_epi8(_mm512_loadu_si512(from), index, _mm512_loadu_si512(from + stride));
    if constexpr (count == 2) return upper;
    const __m512i third = _mm512_loadu_si512(from + 2 * stride);
    const __m512i lower = count == 3
                              ? _mm512_permutexvar_epi8(index, third)
                              : _mm512_permutex2var_epi8(third, index, _mm512_loadu_si512(from + 3 * stride));
    return _mm512_mask_mov_epi8(upper, _mm512_movepi8_mask(index), lower);
  }
};

// Lanes within 16 x 16 pixels.
struct InnerWindow {
  WindowFetch window;
  HWY_ATTR HWY_INLINE InnerWindow(const ChainFrame& f, int)
      : window(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0) {}
  static int before(const PatchFrame&, const PositionRange&) { return 0; }
  HWY_ATTR HWY_INLINE __m512i at(FixedPx x, FixedPx y) { return window.at(x, y); }
};

// The layers of each lane of a cell, first <= l < first + length.
struct LaneLayers {
  __m512i first, length;
};

// Nothing to ask of memory.
struct NothingAhead {
  HWY_ATTR HWY_INLINE void ask() {}
};

// The pixels of layers range.low .. range.high - 1 that are a lane's.
template <class FetchLanes, class Ahead, class To>
HWY_ATTR HWY_INLINE void take_layers(FetchLanes& fetch, const ChainFrame& f, FixedPx x, FixedPx y,
                                     const LaneLayers& layers, const LayerRange& range, Ahead& ahead,
                                     To& to) {
  const FixedPx x_per_layer = f.x_per_layer, y_per_layer = f.y_per_layer;
  const __m512i one = _mm512_set1_epi8(1), length = layers.length;
  __m512i since = _mm512_sub_epi8(_mm512_set1_epi8(static_cast<char>(range.low)), layers.first);
  const int last = range.high;
  for (int l = range.low; l < last; ++l, x += x_per_layer, y += y_per_layer) {
    const __mmask64 m = _mm512_cmplt_epu8_mask(since, length);
    since = _mm512_add_epi8(since, one);
    ahead.ask();
    to.put(l, m, fetch.at(x, y));
  }
}

// Calls visit(type of fetch) with the one that suits the frame's lanes. False where none does.
template <class Visit>
HWY_ATTR HWY_INLINE bool with_inner_rows(int rows, auto columns, Visit visit) {
  constexpr int reach = decltype(columns)::value;
  switch (rows) {
    case 0:
      visit(std::type_identity<InnerRows<2, reach>>());
      return true;
    case 1:
      visit(std::type_identity<InnerRows<3, reach>>());
      return true;
    case 2:
      visit(std::type_identity<InnerRows<4, reach>>());
      return true;
    case 3:
      visit(std::type_identity<InnerRows<5, reach>>());
      return true;
    case 4:
      visit(std::type_identity<InnerRows<6, reach>>());
      return true;
    default:
      return false;
  }
}
template <class Visit>
HWY_ATTR HWY_INLINE bool with_inner_fetch(const PatchFrame& f, Visit visit) {
  if (f.fetch == Fetch::window) {
    visit(std::type_identity<InnerWindow>());
    return true;
  }
  if (f.fetch == Fetch::single) return false;
  // A carry adds one to what the lanes span.
  if (f.columns + 1 < 64) {
    switch (f.rows) {
      case 0:
        visit(std::type_identity<InnerBlock<2>>());
        return true;
      case 1:
        visit(std::type_identity<InnerBlock<3>>());
        return true;
      case 2:
        visit(std::type_identity<InnerBlock<4>>());
        return true;
      default:
        return with_inner_rows(f.rows, std::integral_constant<int, 64>(), visit);
    }
  }
  if (f.columns + 1 < 80) return with_inner_rows(f.rows, std::integral_constant<int, 80>(), visit);
  return with_inner_rows(f.rows, std::integral_constant<int, 128>(), visit);
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
