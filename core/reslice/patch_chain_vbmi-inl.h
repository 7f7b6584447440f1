// A patch of a chain in one go by byte permutes: sums stay in registers from frame to frame. Included once
// per target that has them.
// clang-format off
#if defined(SONOBAND_PATCH_CHAIN_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_CHAIN_VBMI_INL_H
#undef SONOBAND_PATCH_CHAIN_VBMI_INL_H
#else
#define SONOBAND_PATCH_CHAIN_VBMI_INL_H
#endif
// clang-format on

#include "core/reslice/chain_walk.h"
#include "core/reslice/patch_cell_vbmi-inl.h"
#include "core/reslice/patch_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Packing four vectors of 32-bit numbers to bytes mixes their quarters. Stored in this order they come out
// in lane order.
inline int packing_order(int lane) {
  return 16 * (lane / 4 % 4) + 4 * (lane / 16) + lane % 4;
}

HWY_ATTR inline void lay_lanes(const LaneGrid& grid, ChainBoundary& b) {
  b.least = b.greatest = 0;
  const __m512 per_sample = _mm512_set1_ps(b.per_sample), per_row = _mm512_set1_ps(b.per_row);
  __m512 least = _mm512_setzero_ps(), greatest = least;
  for (int i = 0; i < 4; ++i) {
    const __m512 at = _mm512_add_ps(_mm512_mul_ps(per_sample, _mm512_load_ps(grid.a.data() + 16 * i)),
                                    _mm512_mul_ps(per_row, _mm512_load_ps(grid.b.data() + 16 * i)));
    least = _mm512_min_ps(least, at);
    greatest = _mm512_max_ps(greatest, at);
    // Quarter q of vector i goes to quarter i of vector q.
    _mm_store_ps(b.lanes.data() + 4 * i, _mm512_extractf32x4_ps(at, 0));
    _mm_store_ps(b.lanes.data() + 16 + 4 * i, _mm512_extractf32x4_ps(at, 1));
    _mm_store_ps(b.lanes.data() + 32 + 4 * i, _mm512_extractf32x4_ps(at, 2));
    _mm_store_ps(b.lanes.data() + 48 + 4 * i, _mm512_extractf32x4_ps(at, 3));
  }
  b.least = _mm512_reduce_min_ps(least);
  b.greatest = _mm512_reduce_max_ps(greatest);
}

// The layer of each lane where the condition changes, in bytes.
HWY_ATTR HWY_INLINE __m512i threshold_layers(const ChainBoundary& b, float at) {
  const __m512 from = _mm512_set1_ps(at), most = _mm512_set1_ps(255.0F);
  const auto crossing = [&](int q) HWY_ATTR {
    return _mm512_min_ps(_mm512_add_ps(from, _mm512_load_ps(b.lanes.data() + 16 * q)), most);
  };
  if (b.rising) {
    constexpr int up = _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC;
    return _mm512_packus_epi16(_mm512_packs_epi32(_mm512_cvt_roundps_epi32(crossing(0), up),
                                                  _mm512_cvt_roundps_epi32(crossing(1), up)),
                               _mm512_packs_epi32(_mm512_cvt_roundps_epi32(crossing(2), up),
                                                  _mm512_cvt_roundps_epi32(crossing(3), up)));
  }
  constexpr int down = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
  const __m512i one = _mm512_set1_epi16(1);
  return _mm512_packus_epi16(
      _mm512_add_epi16(one, _mm512_packs_epi32(_mm512_cvt_roundps_epi32(crossing(0), down),
                                               _mm512_cvt_roundps_epi32(crossing(1), down))),
      _mm512_add_epi16(one, _mm512_packs_epi32(_mm512_cvt_roundps_epi32(crossing(2), down),
                                               _mm512_cvt_roundps_epi32(crossing(3), down))));
}

HWY_ATTR inline void thresholds(const ChainBoundary& boundary, const PatchSite& site, LayerThresholds& out) {
  out.rising = boundary.rising;
  _mm512_store_si512(out.layer.data(), threshold_layers(boundary, boundary.at(site)));
}

// Lanes for which a condition holds at a layer.
struct Condition {
  __m512i layers;
  LaneMask flip;
  HWY_ATTR HWY_INLINE void settle(const ChainBoundary& b, const PatchSite& site) {
    layers = threshold_layers(b, b.at(site));
    flip = b.rising ? 0 : ~LaneMask{0};
  }
  HWY_ATTR HWY_INLINE LaneMask at(__m512i layer) const {
    return _mm512_cmple_epu8_mask(layers, layer) ^ flip;
  }
  HWY_ATTR HWY_INLINE void always() {
    layers = _mm512_setzero_si512();
    flip = 0;
  }
  HWY_ATTR HWY_INLINE void never() {
    layers = _mm512_setzero_si512();
    flip = ~LaneMask{0};
  }
};

HWY_ATTR HWY_INLINE LaneMask lanes_between(const Condition& from, const Condition& to, const PatchSite& site,
                                           int l) {
  const __m512i layer = _mm512_set1_epi8(static_cast<char>(l));
  return site.lanes & from.at(layer) & ~to.at(layer);
}

// Between two conditions.
HWY_ATTR HWY_INLINE LaneLayers layers_between(const Condition& from, const Condition& to,
                                              const PatchSite& site, const LayerRange& range) {
  __m512i first = _mm512_set1_epi8(static_cast<char>(range.low)),
          last = _mm512_set1_epi8(static_cast<char>(range.high));
  if (from.flip == 0) {
    first = _mm512_max_epu8(first, from.layers);
  } else {
    last = _mm512_min_epu8(last, from.layers);
  }
  if (to.flip == 0) {
    last = _mm512_min_epu8(last, to.layers);
  } else {
    first = _mm512_max_epu8(first, to.layers);
  }
  return {first, _mm512_maskz_subs_epu8(site.lanes, last, first)};
}

// What a chain's pixels go to: the sums of a patch.
template <Rule rule>
struct ToSums {
  Gathered<rule> gathered;
  PatchSums* sums;
  HWY_ATTR explicit ToSums(PatchSums& s) : gathered(s), sums(&s) {}
  HWY_ATTR HWY_INLINE void add(int, LaneMask m, __m512i values) { gathered.add(m, values); }
  // The same in two: how many layers a lane gets, and their values.
  HWY_ATTR HWY_INLINE void count(__m512i layers) { gathered.count(layers); }
  HWY_ATTR HWY_INLINE void put(int, LaneMask m, __m512i values) { gathered.put(m, values); }
  HWY_ATTR void take(const PatchFrame& f, int, FixedPx x, FixedPx y, LaneMask m) {
    gathered.store();
    take_single<rule>(f, &x, &y, &m, 1, *sums);
    gathered = Gathered<rule>(*sums);
  }
};

// Or its layers apart.
struct ToLayers {
  PatchLayers* layers;
  __m512i has_data[2];
  HWY_ATTR explicit ToLayers(PatchLayers& to)
      : layers(&to),
        has_data{_mm512_load_si512(to.has_data.data()), _mm512_load_si512(to.has_data.data() + 32)} {}
  // Whole vectors are stored: what a masked store leaves cannot be read again until it is in the cache.
  HWY_ATTR HWY_INLINE void add(int l, LaneMask m, __m512i values) {
    std::uint8_t* to = layers->values[l].data();
    _mm512_store_si512(to, _mm512_mask_mov_epi8(_mm512_load_si512(to), m, values));
    const auto bit = static_cast<short>(1 << l);
    has_data[0] = _mm512_or_si512(has_data[0], _mm512_maskz_set1_epi16(static_cast<__mmask32>(m), bit));
    has_data[1] = _mm512_or_si512(has_data[1], _mm512_maskz_set1_epi16(static_cast<__mmask32>(m >> 32), bit));
  }
  HWY_ATTR HWY_INLINE void count(__m512i) {}
  HWY_ATTR HWY_INLINE void put(int l, LaneMask m, __m512i values) { add(l, m, values); }
  HWY_ATTR void store() const {
    _mm512_store_si512(layers->has_data.data(), has_data[0]);
    _mm512_store_si512(layers->has_data.data() + 32, has_data[1]);
  }
  HWY_ATTR void take(const PatchFrame& f, int l, FixedPx x, FixedPx y, LaneMask m) {
    alignas(64) std::uint8_t values[patch_lanes];
    fetch_single(f, x, y, values);
    add(l, m, _mm512_load_si512(values));
  }
};

template <class FetchLanes, class To>
HWY_ATTR HWY_INLINE void take_cell(const ChainFrame& f, const PatchSite& site, const Condition& from,
                                   const Condition& to, const LayerRange& range, To& gathered) {
  FetchLanes fetch(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0);
  // Copies, which nothing else points to: they stay in registers.
  To own = gathered;
  const Condition begin = from, end = to;
  const LaneMask lanes = site.lanes;
  const FixedPx x_per_layer = f.x_per_layer, y_per_layer = f.y_per_layer;
  const int last = range.high;
  FixedPx x = f.x_at(site, range.low), y = f.y_at(site, range.low);
  for (int l = range.low; l < last; ++l, x += x_per_layer, y += y_per_layer) {
    const __m512i layer = _mm512_set1_epi8(static_cast<char>(l));
    const LaneMask m = lanes & begin.at(layer) & ~end.at(layer);
    if (m == 0) continue;
    if (l + layers_ahead < last)
      fetch.prefetch(x + layers_ahead * x_per_layer, y + layers_ahead * y_per_layer);
    own.add(l, m, fetch.at(x, y));
  }
  gathered = own;
}

// Calls visit(cell, from, to, range) with the conditions that begin and end each cell of the patch.
template <class Visit>
HWY_ATTR HWY_INLINE int walk_conditions(const ChainBoundary* boundaries, int count, const PatchSite& site,
                                        Visit visit) {
  Condition conditions[2];
  const ChainBoundary* settled = nullptr;  // what conditions[0] is of
  return walk_chain(
      boundaries, count, site,
      [&](int cell, const ChainBoundary* begin, const ChainBoundary* end, const LayerRange& range) HWY_ATTR {
        Condition& from = conditions[0];
        Condition& to = conditions[1];
        if (begin == nullptr) {
          from.always();
        } else if (begin != settled) {
          from.settle(*begin, site);
        }
        if (end == nullptr) {
          to.never();
        } else {
          to.settle(*end, site);
        }
        visit(cell, from, to, range);
        from = to;
        settled = end;
      });
}

// False where a cell's pixels are not all the picture's. Each in a function of its own: sums stay in
// registers.
template <class FetchLanes, class To>
HWY_ATTR HWY_NOINLINE bool take_inner_by(const ChainFrame& f, const PatchSite& site, const Condition& from,
                                         const Condition& to, const LayerRange& range, To& gathered) {
  const PositionRange at(f, site, range);
  const int before = FetchLanes::before(*f.frame, at);
  if (before < 0) return false;
  To own = gathered;
  const LaneLayers layers = layers_between(from, to, site, range);
  own.count(layers.length);
  FetchLanes fetch(f, before);
  NothingAhead nothing;
  take_layers(fetch, f, at.x, at.y, layers, range, nothing, own);
  gathered = own;
  return true;
}
template <class To>
HWY_ATTR HWY_INLINE bool take_inner(const ChainFrame& f, const PatchSite& site, const Condition& from,
                                    const Condition& to, const LayerRange& range, To& gathered) {
  bool held = false;
  with_inner_fetch(*f.frame, [&](auto type) HWY_ATTR {
    held = take_inner_by<typename decltype(type)::type>(f, site, from, to, range, gathered);
  });
  return held;
}

template <class To>
HWY_ATTR HWY_INLINE int take_chain_to(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                      const PatchSite& site, To& gathered) {
  return walk_conditions(boundaries, count, site,
                         [&](int cell, const Condition& from, const Condition& to, const LayerRange& range)
                             HWY_ATTR {
                               const ChainFrame& f = frames[cell];
                               if (take_inner(f, site, from, to, range, gathered)) return;
                               if (f.frame->fetch == Fetch::rows) {
                                 take_cell<RowsFetch>(f, site, from, to, range, gathered);
                               } else {
                                 for (int l = range.low; l < range.high; ++l) {
                                   const LaneMask m = lanes_between(from, to, site, l);
                                   gathered.take(*f.frame, l, f.x_at(site, l), f.y_at(site, l), m);
                                 }
                               }
                             });
}

// Any lane whose pixel, from lane 0 at either position, is not the picture's.
inline bool may_end(const PatchFrame& f, const PositionRange& at) {
  return f.mask != nullptr || whole(std::min(at.x, at.last_x)) + f.least_column < f.first_x ||
         whole(std::max(at.x, at.last_x)) + f.least_column + f.columns + 1 > f.last_x ||
         whole(std::min(at.y, at.last_y)) + f.least_row < f.first_y ||
         whole(std::max(at.y, at.last_y)) + f.least_row + f.rows + 1 > f.last_y;
}

// As take_cell where the frame's picture may end.
template <class FetchLanes, class To>
HWY_ATTR HWY_INLINE void take_cell_ends(const ChainFrame& f, const PatchSite& site, const Condition& from,
                                        const Condition& to, const LayerRange& range, To& gathered,
                                        LaneMask* without) {
  FixedPx x[patch_layers], y[patch_layers];
  LaneMask masks[patch_layers];
  const int layers = range.high - range.low;
  x[0] = f.x_at(site, range.low);
  y[0] = f.y_at(site, range.low);
  masks[0] = lanes_between(from, to, site, range.low);
  for (int i = 1; i < layers; ++i) {
    x[i] = x[i - 1] + f.x_per_layer;
    y[i] = y[i - 1] + f.y_per_layer;
    masks[i] = lanes_between(from, to, site, range.low + i);
  }
  LaneMask in[patch_layers];
  std::copy_n(masks, layers, in);
  inside_permuted(*f.frame, x, y, layers, in);
  FetchLanes fetch(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0);
  for (int i = 0; i < layers; ++i) {
    without[range.low + i] |= masks[i] & ~in[i];
    if (in[i] == 0) continue;
    if (i + layers_ahead < layers) fetch.prefetch(x[i + layers_ahead], y[i + layers_ahead]);
    gathered.add(range.low + i, in[i], fetch.at(x[i], y[i]));
  }
}

template <Rule rule>
HWY_ATTR int take_chain_ends_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                const PatchSite& site, PatchSums& sums, LaneMask* without) {
  ToSums<rule> gathered(sums);
  const int start = walk_conditions(
      boundaries, count, site,
      [&](int cell, const Condition& from, const Condition& to, const LayerRange& range) HWY_ATTR {
        const ChainFrame& f = frames[cell];
        const bool ends = may_end(*f.frame, PositionRange(f, site, range));
        if (!ends && take_inner(f, site, from, to, range, gathered)) return;
        if (f.frame->fetch == Fetch::window) {
          take_cell_ends<WindowFetch>(f, site, from, to, range, gathered, without);
        } else if (f.frame->fetch == Fetch::rows) {
          if (ends) {
            take_cell_ends<RowsFetch>(f, site, from, to, range, gathered, without);
          } else {
            take_cell<RowsFetch>(f, site, from, to, range, gathered);
          }
        } else {
          for (int l = range.low; l < range.high; ++l) {
            const LaneMask m = lanes_between(from, to, site, l);
            const FixedPx at_x = f.x_at(site, l), at_y = f.y_at(site, l);
            const LaneMask in = inside_single(*f.frame, at_x, at_y, m);
            without[l] |= m & ~in;
            gathered.take(*f.frame, l, at_x, at_y, in);
          }
        }
      });
  gathered.gathered.store();
  return start;
}

template <Rule rule>
HWY_ATTR int take_chain_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                           const PatchSite& site, PatchSums& sums) {
  ToSums<rule> gathered(sums);
  const int start = take_chain_to(frames, boundaries, count, site, gathered);
  gathered.gathered.store();
  return start;
}

HWY_ATTR inline int take_chain_apart(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                     const PatchSite& site, PatchLayers& layers) {
  ToLayers apart(layers);
  const int start = take_chain_to(frames, boundaries, count, site, apart);
  apart.store();
  return start;
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
