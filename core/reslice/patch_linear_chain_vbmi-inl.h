// A patch of a chain in one go, blended: sums stay in registers from cell to cell. Included once per target
// that has byte permutes.
// clang-format off
#if defined(SONOBAND_PATCH_LINEAR_CHAIN_VBMI_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SONOBAND_PATCH_LINEAR_CHAIN_VBMI_INL_H
#undef SONOBAND_PATCH_LINEAR_CHAIN_VBMI_INL_H
#else
#define SONOBAND_PATCH_LINEAR_CHAIN_VBMI_INL_H
#endif
// clang-format on

#include "core/reslice/patch_chain_vbmi-inl.h"
#include "core/reslice/patch_linear_vbmi-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {

// A cell of a patch: the conditions that begin and end it, its layers.
struct CellSite {
  const PatchSite& site;
  const Condition& from;
  const Condition& to;
  const LayerRange& range;
  HWY_ATTR HWY_INLINE LaneMask lanes(int l) const { return lanes_between(from, to, site, l); }
};

template <class FetchTaps>
HWY_ATTR HWY_INLINE Bilinear<FetchTaps> bilinear_of(const ChainFrame& f) {
  return {*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0};
}

template <Rule rule, class FetchA, class FetchB>
HWY_ATTR void blend_cell(const ChainFrame& a, const ChainFrame& b, const ChainShare& share,
                         const CellSite& cell, Gathered<rule>& kept) {
  Bilinear<FetchA> of_a = bilinear_of<FetchA>(a);
  Bilinear<FetchB> of_b = bilinear_of<FetchB>(b);
  const float *z_lanes = share.z_lanes.data(), *gap_lanes = share.gap_lanes.data();
  const float z = share.z.at(cell.site, 0), gap = share.gap.at(cell.site, 0);
  const int first = cell.range.low, last = cell.range.high;
  FixedPx xa = a.x_at(cell.site, first) + foot_from_position,
          ya = a.y_at(cell.site, first) + foot_from_position;
  FixedPx xb = b.x_at(cell.site, first) + foot_from_position,
          yb = b.y_at(cell.site, first) + foot_from_position;
  Gathered<rule> gathered = kept;
  for (int l = first; l < last; ++l) {
    const LaneMask m = cell.lanes(l);
    if (m != 0) {
      const auto layer = static_cast<float>(l);
      const Wide of_second =
          shares(z + share.z.per_layer * layer, z_lanes, gap + share.gap.per_layer * layer, gap_lanes);
      const Wide v = blended_words(of_a.at(xa, ya), of_b.at(xb, yb), of_second);
      gathered.add_words(m, v.low, v.high);
    }
    xa += a.x_per_layer;
    ya += a.y_per_layer;
    xb += b.x_per_layer;
    yb += b.y_per_layer;
  }
  kept = gathered;
}

// Beyond the last frame.
template <Rule rule, class FetchTaps>
HWY_ATTR void take_alone(const ChainFrame& f, const CellSite& cell, Gathered<rule>& kept) {
  Bilinear<FetchTaps> values = bilinear_of<FetchTaps>(f);
  Gathered<rule> gathered = kept;
  for (int l = cell.range.low; l < cell.range.high; ++l) {
    const LaneMask m = cell.lanes(l);
    if (m == 0) continue;
    const Wide v = levels_of(
        values.at(f.x_at(cell.site, l) + foot_from_position, f.y_at(cell.site, l) + foot_from_position));
    gathered.add_words(m, v.low, v.high);
  }
  kept = gathered;
}

// False where the lanes lie too far apart for permutes.
template <Rule rule>
HWY_ATTR HWY_INLINE bool blend_by_permutes(const ChainFrame& a, const ChainFrame& b, const ChainShare* share,
                                           const CellSite& cell, Gathered<rule>& gathered) {
  const Fetch fa = a.frame->fetch, fb = b.frame->fetch;
  if (fa == Fetch::single || fb == Fetch::single) return false;
  if (share == nullptr) {
    if (fa == Fetch::rows) {
      take_alone<rule, RowsTaps>(a, cell, gathered);
    } else {
      take_alone<rule, WindowTaps>(a, cell, gathered);
    }
  } else if (fa == Fetch::rows && fb == Fetch::rows) {
    blend_cell<rule, RowsTaps, RowsTaps>(a, b, *share, cell, gathered);
  } else if (fa == Fetch::rows) {
    blend_cell<rule, RowsTaps, WindowTaps>(a, b, *share, cell, gathered);
  } else if (fb == Fetch::rows) {
    blend_cell<rule, WindowTaps, RowsTaps>(a, b, *share, cell, gathered);
  } else {
    blend_cell<rule, WindowTaps, WindowTaps>(a, b, *share, cell, gathered);
  }
  return true;
}

template <Rule rule>
HWY_ATTR int blend_chain_by(const ChainFrame* frames, const ChainShare* shares,
                            const ChainBoundary* boundaries, int count, const PatchSite& site,
                            PatchSums& sums) {
  Gathered<rule> gathered(sums);
  const int start = walk_conditions(
      boundaries, count, site,
      [&](int cell, const Condition& from, const Condition& to, const LayerRange& range) HWY_ATTR {
        const bool alone = cell == 0 || cell == count - 1;
        const ChainFrame& a = frames[std::max(cell - 1, 0)];
        const ChainFrame& b = alone ? a : frames[cell];
        const ChainShare* share = alone ? nullptr : shares + cell - 1;
        if (blend_by_permutes(a, b, share, CellSite{site, from, to, range}, gathered)) return;
        gathered.store();
        for (int l = range.low; l < range.high; ++l)
          blend_layer<rule>(a, b, share, site, l, lanes_between(from, to, site, l), sums);
        gathered = Gathered<rule>(sums);
      });
  gathered.store();
  return start;
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#endif
