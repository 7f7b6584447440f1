// Which patches a tile is cut into: those that span fewest frames and pixel rows.
#pragma once

#include "core/reslice/cull.h"
#include "core/reslice/lattice.h"
#include "core/reslice/patch.h"

namespace sonoband {

struct Tile;

struct PatchChoice {
  LaneShape shape;
  bool turned = false;  // of frames whose pixel columns are turned into rows
};

// What may be chosen beside rectangles of frames as they are.
struct PatchFreedom {
  bool shear = false;
  bool turn = false;
  double turned_pixels = 0;  // that would have to be turned
};

PatchChoice choose_patches(const Tile& tile, const Lattice& lattice, Interpolation interpolation,
                           const PatchFreedom& may);

}  // namespace sonoband
