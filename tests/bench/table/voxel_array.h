// What the peers need before they can show anything: a voxel array filled from the frames, with its holes
// filled.
#pragma once

#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband::bench {

// World-aligned voxels; x runs fastest. 0 is empty.
struct VoxelArray {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  // centre of voxel (0,0,0)
  double spacing_mm = 0.4;
  int nx = 0;
  int ny = 0;
  int nz = 0;
  std::vector<std::uint8_t> voxels;

  std::size_t index(int x, int y, int z) const { return (static_cast<std::size_t>(z) * ny + y) * nx + x; }
};

// An empty array round all frames.
VoxelArray array_for(const SweepView& sweep, double spacing_mm);

// Pixel-nearest, latest wins: every pixel goes into the voxel it lies in (grey 0 becomes 1: 0 means empty).
void paste(const TrackedFrame& frame, VoxelArray& array, Parallel& parallel);

// Every empty voxel with a filled one within a cube of 5 voxels takes the nearest such voxel's value, ties to
// the first in memory order; what lies farther from all data stays empty.
VoxelArray fill_holes(const VoxelArray& array, Parallel& parallel);

}  // namespace sonoband::bench
