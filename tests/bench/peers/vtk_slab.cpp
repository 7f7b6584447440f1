#include "tests/bench/peers/vtk_slab.h"

#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkImageReslice.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>

namespace sonoband::bench {

struct VtkSlab::Parts {
  vtkNew<vtkImageImport> import;
  vtkNew<vtkImageReslice> reslice;
  vtkNew<vtkMatrix4x4> axes;
};

VtkSlab::VtkSlab(const VoxelArray& array, int threads) : parts_(std::make_unique<Parts>()) {
  vtkImageImport* import = parts_->import;
  import->SetImportVoidPointer(const_cast<std::uint8_t*>(array.voxels.data()));
  import->SetDataScalarTypeToUnsignedChar();
  import->SetNumberOfScalarComponents(1);
  import->SetWholeExtent(0, array.nx - 1, 0, array.ny - 1, 0, array.nz - 1);
  import->SetDataExtentToWholeExtent();
  import->SetDataSpacing(array.spacing_mm, array.spacing_mm, array.spacing_mm);
  import->SetDataOrigin(array.origin_mm.x(), array.origin_mm.y(), array.origin_mm.z());
  import->Update();
  vtkImageReslice* reslice = parts_->reslice;
  reslice->SetInputConnection(import->GetOutputPort());
  reslice->SetNumberOfThreads(threads);
  reslice->SetOutputDimensionality(2);
  reslice->SetBackgroundLevel(0);
}

VtkSlab::~VtkSlab() = default;

ConstPixels VtkSlab::render(const ReslicePlane& plane, const RenderSettings& settings) {
  vtkImageReslice* reslice = parts_->reslice;
  for (int row = 0; row < 3; ++row) {
    parts_->axes->SetElement(row, 0, plane.right.v[row]);
    parts_->axes->SetElement(row, 1, plane.down.v[row]);
    parts_->axes->SetElement(row, 2, plane.normal().v[row]);
    parts_->axes->SetElement(row, 3, plane.origin.v[row]);
  }
  reslice->SetResliceAxes(parts_->axes);
  reslice->SetOutputSpacing(plane.pixel_mm, plane.pixel_mm, settings.band.step_mm);
  reslice->SetOutputOrigin(0, 0, 0);
  reslice->SetOutputExtent(0, plane.width - 1, 0, plane.height - 1, 0, 0);
  reslice->SetSlabNumberOfSlices(settings.band.layers());
  reslice->SetSlabSliceSpacingFraction(1);
  switch (settings.compounding) {
    case Compounding::maximum:
      reslice->SetSlabModeToMax();
      break;
    case Compounding::minimum:
      reslice->SetSlabModeToMin();
      break;
    case Compounding::mean:
      reslice->SetSlabModeToMean();
      break;
  }
  if (settings.interpolation == Interpolation::linear) {
    reslice->SetInterpolationModeToLinear();
  } else {
    reslice->SetInterpolationModeToNearestNeighbor();
  }
  reslice->Modified();
  reslice->Update();
  vtkImageData* out = reslice->GetOutput();
  return {static_cast<const std::uint8_t*>(out->GetScalarPointer()), plane.width, plane.height, plane.width};
}

}  // namespace sonoband::bench
