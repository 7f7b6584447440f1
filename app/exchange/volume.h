// A grey voxel array as a MetaImage volume (.mha), written slice by slice: PLUS, 3D Slicer and ITK read it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "app/exchange/file_beside.h"
#include "core/image/image.h"

namespace sonoband::exchange {

// Voxel (i, j, k) has its centre at origin_mm + spacing_mm (i, j, k), along the axes of the world.
struct VoxelLattice {
  std::array<double, 3> origin_mm{};
  std::array<int, 3> dims{1, 1, 1};
  double spacing_mm = 0.5;
};

class VolumeWriter {
 public:
  // `comment` goes into the header as a field of its own. Throws BadInput where the folder refuses.
  VolumeWriter(const std::filesystem::path& path, const VoxelLattice& lattice, const std::string& comment);

  void write_slice(ConstPixels slice);  // k = 0 first; dims[0] x dims[1]
  void finish();                        // after dims[2] slices; throws BadInput where the disk refused

 private:
  FileBeside file_;
  VoxelLattice lattice_;
  int written_ = 0;
};

}  // namespace sonoband::exchange
