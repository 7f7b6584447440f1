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

// Bilinear values of a frame in layers of a patch, for the cells on both sides of it.
struct FrameValues {
  const ChainFrame* frame = nullptr;
  int first = 0, last = 0;  // layers that are known
  Wide layers[patch_layers];
};

template <class FetchTaps>
HWY_ATTR void values_of(const ChainFrame& f, const PatchSite& site, int first, int last, Wide* layers) {
  Bilinear<FetchTaps> values(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0);
  FixedPx x = f.x_at(site, first) + foot_from_position, y = f.y_at(site, first) + foot_from_position;
  for (int l = first; l < last; ++l, x += f.x_per_layer, y += f.y_per_layer) layers[l] = values.at(x, y);
}

HWY_ATTR inline void fill(const ChainFrame& f, const PatchSite& site, int first, int last, Wide* layers) {
  if (first >= last) return;
  if (f.frame->fetch == Fetch::rows) {
    values_of<RowsTaps>(f, site, first, last, layers);
  } else {
    values_of<WindowTaps>(f, site, first, last, layers);
  }
}

// Makes the layers of `range` known, and those between it and what is known.
HWY_ATTR inline void know(FrameValues& values, const ChainFrame& f, const PatchSite& site,
                          const LayerRange& range) {
  if (values.frame != &f) {
    values.frame = &f;
    values.first = values.last = range.low;
  }
  fill(f, site, range.low, values.first, values.layers);
  fill(f, site, values.last, range.high, values.layers);
  values.first = std::min(values.first, range.low);
  values.last = std::max(values.last, range.high);
}

// The second frame's shares at layer l.
template <bool even>
class SharesAt {
 public:
  HWY_ATTR HWY_INLINE SharesAt(const ChainShare& share, const PatchSite& site) : share_(share) {
    if constexpr (even) {
      part_ = share.part.at(site, 0);
      bend_ = share.bend.at(site, 0);
    } else {
      z_ = share.z.at(site, 0);
      gap_ = share.gap.at(site, 0);
    }
  }
  HWY_ATTR HWY_INLINE Wide at(int l) const {
    if constexpr (even) {
      return even_shares(share_, part_ + l * share_.part.per_layer, bend_ + l * share_.bend.per_layer);
    } else {
      const auto layer = static_cast<float>(l);
      return shares(z_ + share_.z.per_layer * layer, share_.z_lanes.data(),
                    gap_ + share_.gap.per_layer * layer, share_.gap_lanes.data());
    }
  }

 private:
  const ChainShare& share_;
  FixedPx part_ = 0, bend_ = 0;
  float z_ = 0, gap_ = 0;
};

template <Rule rule, bool even>
HWY_ATTR void blend_cell(const Wide* a, const Wide* b, const ChainShare& share, const CellSite& cell,
                         Gathered<rule>& sums) {
  const SharesAt<even> of_second(share, cell.site);
  Gathered<rule> gathered = sums;
  for (int l = cell.range.low; l < cell.range.high; ++l) {
    const Wide v = blended_words(a[l], b[l], of_second.at(l));
    gathered.add_words(cell.lanes(l), v.low, v.high);
  }
  sums = gathered;
}

// Beyond the last frame.
template <Rule rule>
HWY_ATTR void take_alone(const Wide* values, const CellSite& cell, Gathered<rule>& sums) {
  Gathered<rule> gathered = sums;
  for (int l = cell.range.low; l < cell.range.high; ++l) {
    const Wide v = levels_of(values[l]);
    gathered.add_words(cell.lanes(l), v.low, v.high);
  }
  sums = gathered;
}

// A frame's own values.
template <class FetchTaps, Rule rule>
HWY_ATTR void take_linear_cell(const ChainFrame& f, const CellSite& cell, Gathered<rule>& sums) {
  Gathered<rule> gathered = sums;
  Bilinear<FetchTaps> values(*f.frame, f.x_per_layer >= 0, f.y_per_layer >= 0);
  const int first = cell.range.low;
  FixedPx x = f.x_at(cell.site, first) + foot_from_position;
  FixedPx y = f.y_at(cell.site, first) + foot_from_position;
  for (int l = first; l < cell.range.high; ++l, x += f.x_per_layer, y += f.y_per_layer) {
    const LaneMask m = cell.lanes(l);
    if (m == 0) continue;
    const Wide v = levels_of(values.at(x, y));
    gathered.add_words(m, v.low, v.high);
  }
  sums = gathered;
}

template <Rule rule>
HWY_ATTR int take_chain_linear_by(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                                  const PatchSite& site, PatchSums& sums) {
  Gathered<rule> gathered(sums);
  const int start = walk_conditions(
      boundaries, count, site,
      [&](int cell, const Condition& from, const Condition& to, const LayerRange& range) HWY_ATTR {
        const ChainFrame& f = frames[cell];
        const CellSite where{site, from, to, range};
        if (f.frame->fetch == Fetch::window) return take_linear_cell<WindowTaps>(f, where, gathered);
        if (f.frame->fetch == Fetch::rows) return take_linear_cell<RowsTaps>(f, where, gathered);
        gathered.store();
        for (int l = range.low; l < range.high; ++l)
          blend_layer<rule>(f, f, nullptr, site, l, where.lanes(l), sums);
        gathered = Gathered<rule>(sums);
      });
  gathered.store();
  return start;
}

template <Rule rule>
HWY_ATTR int blend_chain_by(const ChainFrame* frames, const ChainShare* shares,
                            const ChainBoundary* boundaries, int count, const PatchSite& site,
                            PatchSums& sums) {
  Gathered<rule> gathered(sums);
  FrameValues values[2];  // of even and of odd frames
  const int start = walk_conditions(
      boundaries, count, site,
      [&](int cell, const Condition& from, const Condition& to, const LayerRange& range) HWY_ATTR {
        const bool alone = cell == 0 || cell == count - 1;
        const int before = std::max(cell - 1, 0);
        const ChainFrame& a = frames[before];
        const ChainFrame& b = alone ? a : frames[cell];
        const ChainShare* share = alone ? nullptr : shares + cell - 1;
        const CellSite where{site, from, to, range};
        if (a.frame->fetch != Fetch::single && b.frame->fetch != Fetch::single) {
          FrameValues& of_a = values[before % 2];
          FrameValues& of_b = values[1 - before % 2];
          know(of_a, a, site, range);
          if (alone) return take_alone(of_a.layers, where, gathered);
          know(of_b, b, site, range);
          if (share->even) return blend_cell<rule, true>(of_a.layers, of_b.layers, *share, where, gathered);
          return blend_cell<rule, false>(of_a.layers, of_b.layers, *share, where, gathered);
        }
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
