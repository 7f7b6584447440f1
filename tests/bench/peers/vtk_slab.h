// The peer: VTK's vtkImageReslice in slab mode on a ready voxel array, as PLUS, Slicer and CustusX users have
// it.
#pragma once

#include <memory>

#include "core/reslice/band.h"
#include "tests/bench/peers/voxel_array.h"

namespace sonoband::bench {

class VtkSlab {
 public:
  // Borrows the array; `threads` as VTK divides its output.
  VtkSlab(const VoxelArray& array, int threads);
  ~VtkSlab();

  // Renders the slab anew; the result lives until the next call. Layers as Band, so both paint the same
  // samples.
  ConstPixels render(const ReslicePlane& plane, const RenderSettings& settings);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sonoband::bench
