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

// A frame's bilinear values at layer after layer.
template <class FetchTaps>
class BilinearLayers {
 public:
  HWY_ATTR BilinearLayers(const ChainFrame& f, const PatchSite& site, int first)
      : values_(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0),
        x_(f.x_at(site, first) + foot_from_position),
        y_(f.y_at(site, first) + foot_from_position),
        x_per_layer_(f.x_per_layer),
        y_per_layer_(f.y_per_layer) {}
  HWY_ATTR HWY_INLINE Wide here() { return values_.at(x_, y_); }
  HWY_ATTR HWY_INLINE void next() {
    x_ += x_per_layer_;
    y_ += y_per_layer_;
  }

 private:
  Bilinear<FetchTaps> values_;
  FixedPx x_, y_, x_per_layer_, y_per_layer_;
};

// A cell of a patch: the conditions that begin and end it, its layers.
struct CellSite {
  const PatchSite& site;
  const Condition& from;
  const Condition& to;
  const LayerRange& range;
  HWY_ATTR HWY_INLINE LaneMask lanes(int l) const { return lanes_between(from, to, site, l); }
};

template <Rule rule, class FetchA, class FetchB>
HWY_ATTR void blend_cell(const ChainFrame& a, const ChainFrame& b, const ChainShare& share,
                         const CellSite& cell, Gathered<rule>& gathered) {
  BilinearLayers<FetchA> of_a(a, cell.site, cell.range.low);
  BilinearLayers<FetchB> of_b(b, cell.site, cell.range.low);
  for (int l = cell.range.low; l < cell.range.high; ++l, of_a.next(), of_b.next()) {
    const LaneMask m = cell.lanes(l);
    if (m == 0) continue;
    const Wide of_second = shares(share.z.at(cell.site, l), share.z_lanes.data(), share.gap.at(cell.site, l),
                                  share.gap_lanes.data());
    const Wide v = blended_words(of_a.here(), of_b.here(), of_second);
    gathered.add_words(m, v.low, v.high);
  }
}

// Beyond the last frame.
template <Rule rule, class FetchTaps>
HWY_ATTR void take_alone(const ChainFrame& f, const CellSite& cell, Gathered<rule>& gathered) {
  BilinearLayers<FetchTaps> values(f, cell.site, cell.range.low);
  for (int l = cell.range.low; l < cell.range.high; ++l, values.next()) {
    const LaneMask m = cell.lanes(l);
    if (m == 0) continue;
    const Wide v = levels_of(values.here());
    gathered.add_words(m, v.low, v.high);
  }
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
