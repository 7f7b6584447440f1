// A tile of the picture: the frames that matter to it, and the tables its patches share.
#pragma once

#include <vector>

#include "core/reslice/lattice.h"
#include "core/reslice/patch.h"

namespace sonoband {

constexpr int tile_pixels = 64;  // a tile's width and height: every patch shape divides it

// A candidate as the patches of a tile see it.
struct TileFrame {
  PatchFrame patch;
  ChainFrame at;  // from the tile's first sample, row and layer; `frame` is set where it is used
};

struct Tile {
  LatticeBlock block;
  SampleBox box;
  LaneShape shape;
  LaneGrid grid{};                    // of shape
  std::vector<Candidate> candidates;  // ascending by frame
  std::vector<TileFrame> frames;      // theirs; may be longer

  // False where no frame reaches the tile at sample a, row b. `near` are those that may matter, ascending.
  bool open(const FrameTable& table, const Lattice& lattice, const std::vector<int>& near,
            Interpolation interpolation, int a, int b);
  // Place of a frame among the candidates; it must be one.
  int index_of(int frame) const;

  // The patch that spans fewest frames and pixel rows.
  LaneShape choose_shape(const FrameTable& table, const Lattice& lattice, Interpolation interpolation) const;
  // `taps`: pixels along x and along y that a sample takes: 1 nearest, 2 linear.
  void make_frames(const FrameTable& table, const Lattice& lattice, int a, int b, int taps);
};

// Lanes within width x height of a patch's corner.
LaneMask existing_lanes(LaneShape shape, int width, int height);

}  // namespace sonoband
