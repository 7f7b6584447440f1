// A tile of the picture: the frames that matter to it, and the tables its patches share.
#pragma once

#include <vector>

#include "core/reslice/chain.h"
#include "core/reslice/lattice.h"
#include "core/reslice/patch.h"
#include "core/reslice/picture_part.h"

namespace sonoband {

// In pixels; a power of two each, at least a patch's lanes together.
struct TileSize {
  int across = 64, down = 64;
};
// Of a band of so many layers seen from its lattice: longer where the frames' distances change little along
// one side, so that fewer frames matter to a tile and more of each one's pixel rows; larger where they do
// along both. All its patches are one group (PatchGroup). For nearest; blends take their time elsewhere.
TileSize tile_size(const FrameTable& seen, int layers, Interpolation interpolation);

// A candidate as the patches of a tile see it.
struct TileFrame {
  PatchFrame patch;
  ChainFrame at;  // from the tile's first sample, row and layer; `frame` is set where it is used
};

// Frames of chains that could be thinned, and those of them that were left out.
struct LeftOut {
  std::int64_t reached = 0, left_out = 0;
  // Of all frames, kept ones stay.
  void add(std::size_t all, std::size_t kept) {
    reached += static_cast<std::int64_t>(all);
    left_out += static_cast<std::int64_t>(all) - static_cast<std::int64_t>(kept);
  }
};

// So many frames before a chain's frame is taken its pixels are asked for: memory answers meanwhile, and what
// it gives is still near.
constexpr std::size_t cells_ahead = 2;

struct Tile {
  const FrameTable* table = nullptr;  // what candidates are of
  LatticeBlock block;
  SampleBox box;
  LaneShape shape;
  LaneGrid grid{};                    // of shape
  std::vector<Candidate> candidates;  // ascending by frame
  std::vector<TileFrame> frames;      // theirs; may be longer
  bool is_chain = false;              // candidates are `chain` throughout the tile
  Chain chain;
  std::vector<PicturePart> parts;  // of the candidates' pictures, that the tile takes
  bool turned = false;             // frames are seen turned: lanes along pixel columns
  bool turned_kept = false;        // they are the sweep's turned pictures, else turned_parts
  TurnedParts turned_parts;

  // Finds the candidates of the tile at sample a, row b, and whether they are a chain; `may_end`: one whose
  // pictures end counts. False where no frame reaches it. `near` are those of the table that may matter,
  // ascending.
  bool find(const FrameTable& frame_table, const Lattice& lattice, const std::vector<int>& near,
            Interpolation interpolation, bool may_end, int a, int b, const TileSize& size = {});
  // Thins a chain by the rule of chain.h.
  void thin(Interpolation interpolation, const OutputPixel& pixel, LeftOut& count);
  // Makes what patches share of the candidates. Where parts_to_turn, turned_parts are to be turned before a
  // patch is painted. `may_reshape`: patches may be sheared and frames turned.
  void open(const Lattice& lattice, Interpolation interpolation, bool may_reshape);
  // A candidate's pixels, to be asked for well before they are turned or taken.
  RowsAhead rows_of(std::size_t c) const;
  bool parts_to_turn() const { return turned && !turned_kept; }
  // Place of a frame among the candidates; it must be one.
  int index_of(int frame) const;

  // Candidates' positions from sample a of row b on.
  void place_frames(const Lattice& lattice, int a, int b);
  // Their patches, of `grid`. `taps`: pixels along x and along y that a sample takes: 1 nearest, 2 linear.
  void make_patches(const Lattice& lattice, int taps);

 private:
  bool may_turn(Interpolation interpolation) const;
  void keep_chain_only();
};

// Lanes within width x height of a patch's corner.
LaneMask existing_lanes(LaneShape shape, int width, int height);
// Lanes within width x height from the pixel that lies (a, b) before the patch's corner.
LaneMask existing_lanes(const LaneGrid& grid, int a, int b, int width, int height);

}  // namespace sonoband
