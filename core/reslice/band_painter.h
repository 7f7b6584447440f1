// Paints a picture tile by tile and a tile patch by patch. In a patch the frames take over from one another
// at boundaries (core/reslice/chain.h), or, where they cross, as the algebra of core/reslice/winners.h says.
#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "core/reslice/chain_cells.h"
#include "core/reslice/chain_ends.h"
#include "core/reslice/chain_walk.h"
#include "core/reslice/patch_kernels.h"
#include "core/reslice/patch_totals.h"
#include "core/reslice/tile.h"
#include "core/reslice/winners.h"

namespace sonoband {

// How frames denser than the output are left out.
struct Thinning {
  OutputPixel pixel;                 // to which chains are thinned by the rule of chain.h; 0 mm: they are not
  const FrameTable* rest = nullptr;  // frames for tiles that are no chain; null: all of them
};

// One thread's painter. Tiles may come in any order; none depends on another. For tiles lattice and table are
// in the lattice's own coordinates; for lines the table is in World.
class BandPainter {
 public:
  BandPainter(const FrameTable& table, const RenderSettings& settings, BandImage& image,
              const std::atomic<bool>* stop, const Thinning& thinning = {})
      : table_(table),
        thinning_(thinning),
        stop_(stop),
        linear_(settings.interpolation == Interpolation::linear),
        rule_(rule_of(settings.compounding, table.kind)),
        image_(&image),
        totals_(rule_) {}
  // Layers apart, not compounded.
  BandPainter(const FrameTable& table, const RenderSettings& settings, LayerBlock& layers)
      : table_(table),
        stop_(nullptr),
        linear_(settings.interpolation == Interpolation::linear),
        rule_(settings.compounding == Compounding::minimum ? Rule::minimum : Rule::maximum),
        layers_(&layers),
        totals_(rule_) {}

  // The tiles of samples [a, a + width) from row b on.
  struct Strip {
    int a = 0, b = 0, width = 0;
  };
  // A tile's pixels are asked for while the one before is painted, across strips too.
  void paint_strips(const Lattice& lattice, const std::vector<Strip>& strips, const TileSize& size);

  const LeftOut& left_out() const { return left_out_; }
  bool turned_parts() const { return turned_parts_; }

  // Rows [first, last) of any bundle, samples [a, a + 64).
  void paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first, int last);

 private:
  Interpolation interpolation() const { return linear_ ? Interpolation::linear : Interpolation::nearest; }
  // Returns a cell for the next patch to start from.
  int paint_cells(const ChainCells& cells, const PatchSite& site);
  int paint_layers(const ChainCells& cells, PatchSite site, int first_layer);
  void blend_cell(const ChainCells& cells, int cell, const PatchSite& site, const LayerRange& range,
                  LaneMask* masks);
  bool find_chain(const std::vector<Candidate>& candidates, const SampleBox& box, Chain& chain) const;
  // Chains may be taken whose pictures end.
  bool may_end() const { return !linear_ && !apart(); }
  // A chain's frames are taken one after another, each in all patches of a tile.
  bool takes_cells() const { return !linear_ && !apart() && patch_kernels().take_cell != nullptr; }
  // What a tile's, or a patch's, frames are of.
  const FrameTable& table() const { return *tile_.table; }
  // Those that may matter to a box, ascending.
  std::vector<int> frames_near(const FrameTable& of, const SampleBox& box) const;
  void thin(const std::vector<Candidate>& candidates, const SampleBox& box, Chain& chain);
  template <class Paint>
  void paint_patches(const LatticeBlock& region, Paint paint);
  template <class Visit>
  void for_patches(const LatticeBlock& region, Visit visit);
  void store(const PatchSite& site);
  void take_group();
  void paint_group();
  void paint_chain(const Lattice& lattice, const LatticeBlock& region, const SampleBox& box,
                   const std::vector<Candidate>& candidates, const Chain& chain);
  // Of each table.
  struct Reach {
    std::vector<int> frames, rest;
  };
  Reach reach_of(const SampleBox& box) const;
  bool open_tile(Tile& tile, const Lattice& lattice, const Reach& reach, int a, int b, const TileSize& size);
  void paint_tile(const Lattice& lattice);
  void paint_region(const Lattice& lattice, const LatticeBlock& region, const std::vector<int>& frames);
  void paint_parts(const Lattice& lattice, const LatticeBlock& region, const std::vector<int>& frames);
  void paint_block(const Lattice& lattice, const LatticeBlock& block, const std::vector<int>& frames);
  void paint_place(const std::vector<Candidate>& candidates, const std::vector<const PatchFrame*>& frames);
  void paint_shares(const std::vector<Candidate>& candidates, const std::vector<const PatchFrame*>& frames,
                    const LayerRange& range);
  void blend_shares(const std::vector<Candidate>& candidates, const std::vector<const PatchFrame*>& frames,
                    std::size_t a, int b, const LayerRange& range);

  // One of two frames to blend, with storage for its layers.
  struct BlendSide {
    int frame = 0;  // index into the table
    const PatchFrame* patch = nullptr;
    std::array<FixedPx, patch_layers> x, y;  // feet
    std::array<float, patch_layers> z;
    float z_per_sample = 0, z_per_row = 0;
    LinearSide side() const { return {patch, x.data(), y.data(), z.data(), z_per_sample, z_per_row}; }
  };
  void blend(BlendSide& a, BlendSide* b, int layers, LaneMask* masks);
  void blend_lane(const BlendSide& a, const BlendSide* b, int l, int lane);

  bool apart() const { return image_ == nullptr; }
  void blank(const LatticeBlock& block);
  void store_layer(int layer, int a, int b) { totals_.store(*layers_, layer, a, b, tile_.shape); }
  bool stopped() const { return stop_ != nullptr && stop_->load(std::memory_order_relaxed); }

  const FrameTable& table_;
  Thinning thinning_;
  LeftOut left_out_;
  bool turned_parts_ = false;
  const std::atomic<bool>* stop_;  // may be null
  bool linear_;
  Rule rule_;
  BandImage* image_ = nullptr;  // or `layers_`
  LayerBlock* layers_ = nullptr;
  PatchTotals totals_;
  PatchLayers apart_;
  Tile tile_, next_tile_;
  ChainCells cells_;
  ChainEnds ends_;
  PatchGroup group_;
  // By patch of group_: cells in which a frame's picture may end.
  std::array<std::vector<int>, group_patches> edges_;
  Winners winners_;
  PatchPlace place_;
  BlendSide side_a_, side_b_;
};

}  // namespace sonoband
