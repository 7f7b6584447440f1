// A cell of a chain in one patch of a tile after another, by byte permutes: what is the frame's stays in
// registers. Included once per target that has them.
// clang-format off
#if defined(SONOBAND_PATCH_GROUP_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_GROUP_VBMI_INL_H
#undef SONOBAND_PATCH_GROUP_VBMI_INL_H
#else
#define SONOBAND_PATCH_GROUP_VBMI_INL_H
#endif
// clang-format on

#include <bit>

#include "core/reslice/patch_chain_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// Layers of a cell in sixteen patches, as walk_chain finds them.
struct CellLayers {
  alignas(64) std::int32_t low[16], high[16];

  // Bit i: patch i has any. Not by a compare's mask: g++ 12 may spill its 16 bits and read 32 of them.
  HWY_ATTR std::uint32_t find(const ChainBoundary& from, const ChainBoundary& to, const PatchGroup& group,
                              int patch) {
    const PatchSite& site = group.sites[patch];
    const __m512i first = _mm512_set1_epi32(site.first), depth = _mm512_set1_epi32(site.depth);
    const __m512 da = _mm512_load_ps(group.da.data() + patch), db = _mm512_load_ps(group.db.data() + patch);
    __m512i l = first, h = depth;
    if (!from.always) {
      const __m512 at = change_at(from, da, db);
      if (from.rising) {
        l = _mm512_max_epi32(l, up(at, from.least));
      } else {
        h = _mm512_min_epi32(h, after(at, from.greatest));
      }
    }
    if (!to.never) {
      const __m512 at = change_at(to, da, db);
      if (to.rising) {
        h = _mm512_min_epi32(h, up(at, to.greatest));
      } else {
        l = _mm512_max_epi32(l, after(at, to.least));
      }
    }
    _mm512_store_si512(low, l);
    _mm512_store_si512(high, h);
    const __m512i some = _mm512_srai_epi32(_mm512_sub_epi32(l, h), 31);
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm512_cvtepi32_epi8(some)));
  }

 private:
  HWY_ATTR static __m512 change_at(const ChainBoundary& b, __m512 da, __m512 db) {
    return _mm512_add_ps(_mm512_set1_ps(b.first),
                         _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(b.per_sample), da),
                                       _mm512_mul_ps(_mm512_set1_ps(b.per_row), db)));
  }
  HWY_ATTR static __m512 bounded(__m512 at, float lanes) {
    return _mm512_min_ps(_mm512_max_ps(_mm512_add_ps(at, _mm512_set1_ps(lanes)), _mm512_set1_ps(-2)),
                         _mm512_set1_ps(300));
  }
  HWY_ATTR static __m512i up(__m512 at, float lanes) {
    return _mm512_cvt_roundps_epi32(bounded(at, lanes), _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
  }
  HWY_ATTR static __m512i after(__m512 at, float lanes) {
    return _mm512_add_epi32(
        _mm512_cvt_roundps_epi32(bounded(at, lanes), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC),
        _mm512_set1_epi32(1));
  }
};

template <Rule rule, class FetchLanes>
HWY_ATTR HWY_NOINLINE int take_cell_of(const ChainFrame& f, const ChainBoundary* boundaries, bool ends,
                                       PatchGroup& group, std::uint8_t* at_edge) {
  const ChainBoundary from = boundaries[0], to = boundaries[1];
  FetchLanes fetch(f, 0);
  RowsAhead ahead = group.ahead;
  CellLayers layers;
  Condition begin, end;
  begin.always();
  end.never();
  const PositionRange of_group(f, group);
  const bool ends_here = ends && may_end(*f.frame, of_group);
  const bool held = FetchLanes::before(*f.frame, of_group) == 0;
  int edges = 0;
  for (int patch = 0; patch < group.count; patch += 16) {
    std::uint32_t met = layers.find(from, to, group, patch);
    if (group.count - patch < 16) met &= (1U << (group.count - patch)) - 1;
    for (; met != 0; met &= met - 1) {
      const int i = std::countr_zero(met), at = patch + i;
      const PatchSite& site = group.sites[at];
      const LayerRange range{layers.low[i], layers.high[i]};
      const PositionRange positions(f, site, range);
      if (ends_here && may_end(*f.frame, positions)) {
        at_edge[edges++] = static_cast<std::uint8_t>(at);
        continue;
      }
      const int before = held ? 0 : FetchLanes::before(*f.frame, positions);
      if (before < 0) {
        take_chain_by<rule>(&f, boundaries, 1, site, group.sums[at]);
        continue;
      }
      if (!from.always) begin.settle(from, site);
      if (!to.never) end.settle(to, site);
      ToSums<rule> gathered(group.sums[at]);
      const LaneLayers lanes = layers_between(begin, end, site, range);
      gathered.count(lanes.length);
      if (before == 0) {
        take_layers(fetch, f, positions.x, positions.y, lanes, range, ahead, gathered);
      } else {
        FetchLanes moved(f, before);
        take_layers(moved, f, positions.x, positions.y, lanes, range, ahead, gathered);
      }
      gathered.gathered.store();
    }
  }
  group.ahead = ahead;
  return edges;
}

template <Rule rule>
HWY_ATTR int take_cell_by(const ChainFrame& f, const ChainBoundary* boundaries, bool ends, PatchGroup& group,
                          std::uint8_t* at_edge) {
  if (boundaries[0].never || boundaries[1].always) return 0;
  int edges = 0;
  if (with_inner_fetch(*f.frame, [&](auto type) HWY_ATTR {
        edges = take_cell_of<rule, typename decltype(type)::type>(f, boundaries, ends, group, at_edge);
      }))
    return edges;
  for (int i = 0; i < group.count; ++i) {
    if (ends) {
      at_edge[edges++] = static_cast<std::uint8_t>(i);
    } else {
      take_chain_by<rule>(&f, boundaries, 1, group.sites[i], group.sums[i]);
    }
  }
  return edges;
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
