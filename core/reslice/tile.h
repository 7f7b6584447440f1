// A tile of the picture: the frames that matter to it, and the tables its patches share.
#pragma once

#include <vector>

#include "core/reslice/lattice.h"
#include "core/reslice/patch.h"

namespace sonoband {

constexpr int tile_pixels = 64;  // a tile's width and height: every patch shape divides it

// A candidate as the patches of a tile see it: positions of lane 0 are affine in sample, row and layer.
struct TileFrame {
  PatchFrame patch;
  FixedPx x = 0, x_per_sample = 0, x_per_row = 0, x_per_layer = 0;  // at the tile's first sample, row, layer
  FixedPx y = 0, y_per_sample = 0, y_per_row = 0, y_per_layer = 0;
};

struct Tile {
  LatticeBlock block;
  SampleBox box;
  LaneShape shape;
  std::vector<Candidate> candidates;  // ascending by frame
  std::vector<TileFrame> frames;      // theirs; may be longer

  // False where no frame reaches the tile at sample a, row b. `near` are those that may matter, ascending.
  bool open(const FrameTable& table, const Lattice& lattice, const std::vector<int>& near,
            Interpolation interpolation, int a, int b);
  // Place of a frame among the candidates; it must be one.
  int index_of(int frame) const;

  // The patch that spans fewest frames and pixel rows.
  LaneShape choose_shape(const FrameTable& table, const Lattice& lattice) const;
  // `taps`: pixels along x and along y that a sample takes: 1 nearest, 2 linear.
  void make_frames(const FrameTable& table, const Lattice& lattice, int a, int b, int taps);
};

// Lanes within width x height of a patch's corner.
LaneMask existing_lanes(LaneShape shape, int width, int height);

}  // namespace sonoband
