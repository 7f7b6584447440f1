// Paints tiles of a picture with the nearest B-scan's pixels, patch by patch.
#pragma once

#include "core/reslice/chain.h"
#include "core/reslice/lattice.h"
#include "core/reslice/patch_totals.h"
#include "core/reslice/winners.h"

namespace sonoband {

constexpr int tile_pixels = 64;  // a tile's width and height: every patch shape divides it

// One thread's painter. Tiles may come in any order; none depends on another.
class NearestPainter {
 public:
  NearestPainter(const FrameTable& table, Compounding how, BandImage& image)
      : table_(table), rule_(rule_of(how, table.kind)), image_(image), totals_(rule_) {}

  // `frames` are those that may matter, ascending.
  void paint_tile(const Lattice& lattice, const std::vector<int>& frames, int a, int b);

  // Rows [first, last) of any bundle, samples [a, a + 64).
  void paint_lines(const LineBundle& bundle, const std::vector<int>& frames, int a, int first, int last);

 private:
  // A candidate of the tile as its patches see it: positions are affine in sample, row and layer.
  struct TileFrame {
    PatchFrame patch;
    FixedPx x = 0, x_per_sample = 0, x_per_row = 0,
            x_per_layer = 0;  // at sample 0, row 0, layer 0 of the tile
    FixedPx y = 0, y_per_sample = 0, y_per_row = 0, y_per_layer = 0;
  };
  // Where the frames from `member` on begin: value >= 0.
  struct Boundary {
    PatchFunction at_tile;
    float extent = 0;  // over a patch, from its centre
    float centre = 0;  // of a patch, from lane 0
    bool always = false, never = false;
  };

  LaneShape choose_shape(const Lattice& lattice) const;
  void make_tile_frames(const Lattice& lattice, int a, int b, LaneShape shape);
  void make_boundaries(const Lattice& lattice, const Chain& chain, const std::vector<Candidate>& candidates,
                       int a, int b, int l, int depth, LaneShape shape);
  void paint_chain(const Chain& chain, const std::vector<int>& tile_frames, int da, int db, int l, int depth,
                   LaneMask lanes);
  void paint_patch(const Lattice& lattice, const LatticeBlock& block, int tile_a, int tile_b,
                   LaneShape shape);
  void paint_general(const std::vector<Candidate>& candidates, const std::vector<const PatchFrame*>& frames,
                     const PatchPlace& place);

  const FrameTable& table_;
  Rule rule_;
  BandImage& image_;
  PatchTotals totals_;
  LaneGrid grid_{};
  std::vector<Candidate> candidates_;   // of the tile
  std::vector<TileFrame> tile_frames_;  // theirs
  std::vector<Boundary> boundaries_;
  Winners winners_;
  PatchPlace place_;
};

}  // namespace sonoband
