// Masks and sums of 64 lanes whose pixels come by byte permutes (patch_fetch_vbmi-inl.h). Included once per
// target that has them.
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
#include "core/reslice/patch_fetch_vbmi-inl.h"
#include "core/reslice/patch_plain-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

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

// Of lanes whose whole part is in 0 .. 127 from `from`, those with first <= pixel <= last.
HWY_ATTR HWY_INLINE __mmask64 within(__m512i whole_part, int from, int first, int last) {
  const int least = std::max(first - from, 0), most = std::min(last - from, 127);
  if (least > most) return 0;
  const __m512i from_least = _mm512_sub_epi8(whole_part, _mm512_set1_epi8(static_cast<char>(least)));
  return _mm512_cmple_epu8_mask(from_least, _mm512_set1_epi8(static_cast<char>(most - least)));
}

// The frame's mask where its picture is.
inline PatchFrame mask_as_picture(const PatchFrame& f) {
  PatchFrame of_mask = f;
  of_mask.pixels = f.mask;
  of_mask.stride = f.mask_stride;
  return of_mask;
}

template <class FetchLanes>
HWY_ATTR void in_mask_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers,
                               LaneMask* masks) {
  FetchLanes fetch(mask_as_picture(f), layers < 2 || x[1] >= x[0], layers < 2 || y[1] >= y[0]);
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    const __m512i v = fetch.at(x[l], y[l]);
    masks[l] &= _mm512_test_epi8_mask(v, v);
  }
}

HWY_ATTR inline void inside_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers,
                                     LaneMask* masks) {
  const Carries carries_x(f.part_x.data()), carries_y(f.part_y.data());
  const __m512i column = _mm512_load_si512(f.column.data()), row = _mm512_load_si512(f.row.data());
  const __m512i one = _mm512_set1_epi8(1);
  for (int l = 0; l < layers; ++l) {
    if (masks[l] == 0) continue;
    const __m512i at_x = _mm512_mask_add_epi8(column, carries_x.at(x[l]), column, one);
    const __m512i at_y = _mm512_mask_add_epi8(row, carries_y.at(y[l]), row, one);
    LaneMask kept = masks[l];
    kept &= within(at_x, whole(x[l]) + f.least_column, f.first_x, f.last_x);
    kept &= within(at_y, whole(y[l]) + f.least_row, f.first_y, f.last_y);
    masks[l] = kept;
  }
  if (f.mask == nullptr) return;
  if (f.fetch == Fetch::rows) {
    in_mask_permuted<RowsFetch>(f, x, y, layers, masks);
  } else {
    in_mask_permuted<WindowFetch>(f, x, y, layers, masks);
  }
}

// Of coloured samples: how many, and their velocities. Only means of Doppler have them.
template <Rule rule>
struct ColourSums {
  HWY_ATTR explicit ColourSums(const PatchSums&) {}
  HWY_ATTR void store(PatchSums&) const {}
};
template <>
struct ColourSums<Rule::mean_doppler> {
  __m512i count;
  WideSum velocity;
  HWY_ATTR explicit ColourSums(const PatchSums& sums)
      : count(_mm512_load_si512(sums.coloured.data())), velocity(sums.velocity.data()) {}
  HWY_ATTR HWY_INLINE void add(__mmask64 colour, __m512i v) {
    count = _mm512_mask_add_epi8(count, colour, count, _mm512_set1_epi8(1));
    velocity.add_signed(_mm512_maskz_permutex2var_epi8(colour, _mm512_load_si512(velocity_table.level), v,
                                                       _mm512_load_si512(velocity_table.level + 64)));
  }
  HWY_ATTR void store(PatchSums& sums) const {
    _mm512_store_si512(sums.coloured.data(), count);
    velocity.store(sums.velocity.data());
  }
};

// What a patch has gathered, in registers.
template <Rule rule>
class Gathered {
 public:
  HWY_ATTR HWY_INLINE explicit Gathered(PatchSums& sums)
      : sums_(&sums),
        count_(_mm512_load_si512(sums.count.data())),
        best_(_mm512_load_si512(sums.extreme.data())),
        sum_(sums.sum.data()),
        colours_(sums) {}

  HWY_ATTR HWY_INLINE void add(__mmask64 m, __m512i v) {
    count_ = _mm512_mask_add_epi8(count_, m, count_, _mm512_set1_epi8(1));
    put(m, v);
  }
  HWY_ATTR HWY_INLINE void count(__m512i layers) { count_ = _mm512_add_epi8(count_, layers); }
  HWY_ATTR HWY_INLINE void put(__mmask64 m, __m512i v) {
    if constexpr (rule == Rule::maximum) {
      best_ = _mm512_mask_max_epu8(best_, m, best_, v);
    } else if constexpr (rule == Rule::minimum) {
      best_ = _mm512_mask_min_epu8(best_, m, best_, v);
    } else if constexpr (rule == Rule::mean_grey) {
      sum_.add_unsigned(_mm512_maskz_mov_epi8(m, v));
    } else {
      const __mmask64 colour = m & _mm512_movepi8_mask(v);
      sum_.add_unsigned(_mm512_maskz_mov_epi8(m & ~colour, v));
      if (colour != 0) colours_.add(colour, v);
    }
  }

  // Of words, lanes in order.
  HWY_ATTR HWY_INLINE void add_words(__mmask64 m, __m512i low, __m512i high) {
    if constexpr (rule == Rule::mean_grey) {
      count_ = _mm512_mask_add_epi8(count_, m, count_, _mm512_set1_epi8(1));
      sum_.low = _mm512_mask_add_epi16(sum_.low, static_cast<__mmask32>(m), sum_.low, low);
      sum_.high = _mm512_mask_add_epi16(sum_.high, static_cast<__mmask32>(m >> 32), sum_.high, high);
    } else {
      // Packing mixes the words' quarters.
      const __m512i order = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);
      add(m, _mm512_permutexvar_epi64(order, _mm512_packus_epi16(low, high)));
    }
  }

  HWY_ATTR HWY_INLINE void store() const {
    _mm512_store_si512(sums_->count.data(), count_);
    if constexpr (rule == Rule::maximum || rule == Rule::minimum) {
      _mm512_store_si512(sums_->extreme.data(), best_);
    } else {
      sum_.store(sums_->sum.data());
      colours_.store(*sums_);
    }
  }

 private:
  PatchSums* sums_;
  __m512i count_, best_;
  WideSum sum_;
  [[no_unique_address]] ColourSums<rule> colours_;
};

constexpr int layers_ahead = 12;  // that memory takes to answer

template <Rule rule, class FetchLanes>
HWY_ATTR void take_permuted(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                            int layers, PatchSums& sums) {
  FetchLanes fetch(f, layers < 2 || x[1] >= x[0], layers < 2 || y[1] >= y[0]);
  Gathered<rule> gathered(sums);
  for (int l = 0; l < layers; ++l) {
    const __mmask64 m = masks[l];
    if (m == 0) continue;
    if (l + layers_ahead < layers) fetch.prefetch(x[l + layers_ahead], y[l + layers_ahead]);
    gathered.add(m, fetch.at(x[l], y[l]));
  }
  gathered.store();
}

HWY_ATTR inline void hold(const LayerThresholds& thresholds, bool holding, int first, int last,
                          LaneMask* masks) {
  const __m512i layers = _mm512_load_si512(thresholds.layer.data());
  const LaneMask flip = thresholds.rising == holding ? 0 : ~LaneMask{0};
  for (int l = first; l < last; ++l)
    masks[l - first] &= _mm512_cmple_epu8_mask(layers, _mm512_set1_epi8(static_cast<char>(l))) ^ flip;
}

HWY_ATTR inline void half_space(const LaneGrid& grid, const float* base, float per_sample, float per_row,
                                int layers, LaneMask* masks) {
  alignas(64) float lane_offset[patch_lanes];
  lane_offsets(grid, per_sample, per_row, lane_offset);
  __m512 offset[4];
  for (int i = 0; i < 4; ++i) offset[i] = _mm512_load_ps(lane_offset + 16 * i);
  for (int l = 0; l < layers; ++l) {
    const __m512 least = _mm512_set1_ps(-base[l]);
    LaneMask m = 0;
    for (int i = 0; i < 4; ++i) m |= LaneMask{_mm512_cmp_ps_mask(offset[i], least, _CMP_GE_OQ)} << (16 * i);
    masks[l] = m;
  }
}

template <Rule rule>
HWY_ATTR void take_by(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks,
                      int layers, PatchSums& sums) {
  switch (f.fetch) {
    case Fetch::rows:
      return take_permuted<rule, RowsFetch>(f, x, y, masks, layers, sums);
    case Fetch::window:
      return take_permuted<rule, WindowFetch>(f, x, y, masks, layers, sums);
    case Fetch::single:
      return take_single<rule>(f, x, y, masks, layers, sums);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
