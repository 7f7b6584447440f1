// The table of vector kernels that patches are painted with, chosen at run time by Highway.
#pragma once

#include "core/reslice/patch.h"

namespace sonoband {

// The vector code, one set for each instruction set; the best the processor has is chosen at run time. All
// sets give the same bits.
struct PatchKernels {
  std::int64_t target = 0;  // Highway's bit of the instruction set

  // Fills `lanes`, `least` and `greatest` for `per_sample` and `per_row`.
  void (*lay_lanes)(const LaneGrid& grid, ChainBoundary& boundary);

  // Of one patch.
  void (*thresholds)(const ChainBoundary& boundary, const PatchSite& site, LayerThresholds& out);

  // Compounds a patch whose lanes of frame j lie between boundaries[j] and boundaries[j + 1], for j < count;
  // where boundary j + 1 holds, so does boundary j.
  // Returns the first cell with layers in the patch, or one near it.
  int (*take_chain)(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                    const PatchSite& site, Rule rule, PatchSums& sums);

  // The same where pictures end: lanes whose frame has no pixel there are added to `without`, by layer.
  int (*take_chain_ends)(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                         const PatchSite& site, Rule rule, PatchSums& sums, LaneMask* without);

  // As take_chain or take_chain_ends, of one cell, between boundaries[0] and [1], in all patches of a group:
  // what is the frame's is made ready once. Patches in which its picture may end (`ends`) are left out; their
  // numbers go to at_edge. Returns how many. Null where patches are better taken one by one.
  int (*take_cell)(const ChainFrame& frame, const ChainBoundary* boundaries, bool ends, Rule rule,
                   PatchGroup& group, std::uint8_t* at_edge);

  // Fills the lanes of either kind.
  void (*lay_share)(const LaneGrid& grid, ChainShare& share);

  // As take_chain, of bilinear values: cell j lies between frames[j - 1] and frames[j], shared as shares[j -
  // 1] says; the first and the last cell have one frame. All taps must be in picture or beyond its edge, none
  // masked.
  int (*blend_chain)(const ChainFrame* frames, const ChainShare* shares, const ChainBoundary* boundaries,
                     int count, const PatchSite& site, Rule rule, PatchSums& sums);

  // As take_chain, of bilinear values; taps as for blend_chain.
  int (*take_chain_linear)(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                           const PatchSite& site, Rule rule, PatchSums& sums);

  // As take_chain of layers apart: writes values of the lanes that a frame gives, and adds these to has_data.
  int (*take_chain_apart)(const ChainFrame* frames, const ChainBoundary* boundaries, int count,
                          const PatchSite& site, PatchLayers& layers);

  // Whole and fractional offsets of all lanes: a per_sample + b per_row, cut off to 1/65536 pixel. Returns
  // their extremes.
  OffsetSpan (*lane_positions)(const LaneGrid& grid, FixedPx per_sample, FixedPx per_row,
                               std::int32_t* offsets);
  // Splits offsets into 16-bit fractions and whole parts less `least`.
  void (*split_positions)(const std::int32_t* offsets, int least, std::uint16_t* fractions,
                          std::uint8_t* wholes);

  // masks[l - first] &= lanes where the condition holds, or where it does not, for first <= l < last.
  void (*hold)(const LayerThresholds& thresholds, bool holding, int first, int last, LaneMask* masks);

  // masks[l] = lanes where base[l] + a per_sample + b per_row >= 0.
  void (*half_space)(const LaneGrid& grid, const float* base, float per_sample, float per_row, int layers,
                     LaneMask* masks);

  // masks[l] &= lanes whose pixel is the picture's and in its mask.
  void (*inside)(const PatchFrame& f, const FixedPx* x, const FixedPx* y, int layers, LaneMask* masks);

  // Compounds the pixels of the lanes in masks[l] at positions x[l], y[l] of lane 0. A position is the foot +
  // 1/2 pixel, so that its whole part is the pixel. Those lanes must lie in the picture.
  void (*take)(const PatchFrame& f, const FixedPx* x, const FixedPx* y, const LaneMask* masks, int layers,
               Rule rule, PatchSums& sums);

  // Fills changes[l] for every layer.
  void (*find_changes)(const RulingCondition& condition, RulingChange* changes);

  // Compounds samples sample .. sample + 7 of eight lines: where `from` holds and `to` does not.
  void (*take_rulings)(const RulingCell* cells, int count, const RulingLayer* layers, int sample,
                       LaneMask lanes, Rule rule, PatchSums& sums);

  // Compounds bilinear samples of two frames, blended by distance: (a |zb| + b |za|) / (|za| + |zb|), in
  // 1/256 of a level, rounded once. The z have opposite signs. Feet must lie in the pictures; taps beyond a
  // picture's edge count as the edge, which renormalised weights amount to. Grey only.
  void (*blend)(const LaneGrid& grid, const LinearSide& a, const LinearSide& b, const LaneMask* masks,
                int layers, Rule rule, PatchSums& sums);

  // masks[l] &= lanes whose four taps, those beyond the edge not counted, are all in the mask.
  void (*taps_inside)(const PatchFrame& f, const std::uint8_t* mask, std::ptrdiff_t mask_stride,
                      const FixedPx* x, const FixedPx* y, int layers, LaneMask* masks);

  // Pixel (left + i, top + j) to to[i * to_stride + j], for i < columns and j < rows rounded up to 16; beyond
  // the picture the nearest of it. Nothing where no column is the picture's.
  void (*turn)(const PictureRows& picture, int left, int top, int columns, int rows, std::uint8_t* to,
               std::ptrdiff_t to_stride);
};

const PatchKernels& patch_kernels();

}  // namespace sonoband
