// A chain laid out for the patches of a tile: what a patch needs of each frame, boundary and pair of frames.
#pragma once

#include <vector>

#include "core/reslice/chain.h"
#include "core/reslice/tile.h"

namespace sonoband {

// Nearest and unblended: a cell is a member's, begun by the bisector with the one before. Else linear: a cell
// lies between two members, begun by the plane of the one before.
struct ChainCells {
  std::vector<int> members;               // places in the tile's frames
  std::vector<ChainFrame> frames;         // theirs
  std::vector<TileDistance> distances;    // theirs; of blends and of chains whose pictures end
  std::vector<float> reaches;             // theirs, in mm; of chains whose pictures end
  std::vector<int> by_capture;            // cells in order of capture; of chains whose pictures end
  std::vector<ChainShare> shares;         // between neighbours; of blends only
  std::vector<ChainBoundary> boundaries;  // one more than cells
  bool grey_taps = false;                 // linear only: all taps are grey and kept by the mask
  bool unblended = false;                 // grey_taps only: a cell has its member's bilinear values
};

// The mask keeps every tap of every foot in the box.
bool all_taps_kept(const FrameTable& table, const FrameEntry& frame, const SampleBox& box);

// Of the samples of `box`, which lie in the tile; layer 0 of the cells is layer l. `chain` is of
// `candidates`, which are some of the tile's.
void lay_out(const Lattice& lattice, const Tile& tile, const Chain& chain,
             const std::vector<Candidate>& candidates, const SampleBox& box, int l,
             Interpolation interpolation, ChainCells& cells);

}  // namespace sonoband
