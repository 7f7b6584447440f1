// VTK's vtkImageReslice in slab mode on a ready voxel array, as PLUS, Slicer and CustusX users have it.
#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkImageReslice.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkVersion.h>

#include "tests/bench/table/peer.h"

namespace sonoband::bench {
namespace {

class VtkSlab final : public Peer {
 public:
  VtkSlab(const VoxelArray& array, int threads);
  std::string name() const override {
    return std::string("vtkImageReslice, ") + vtkVersion::GetVTKSourceVersion();
  }
  ConstPixels render(const ReslicePlane& plane, const RenderSettings& settings) override;

 private:
  vtkNew<vtkImageImport> import_;
  vtkNew<vtkImageReslice> reslice_;
  vtkNew<vtkMatrix4x4> axes_;
};

VtkSlab::VtkSlab(const VoxelArray& array, int threads) {
  import_->SetImportVoidPointer(const_cast<std::uint8_t*>(array.voxels.data()));
  import_->SetDataScalarTypeToUnsignedChar();
  import_->SetNumberOfScalarComponents(1);
  import_->SetWholeExtent(0, array.nx - 1, 0, array.ny - 1, 0, array.nz - 1);
  import_->SetDataExtentToWholeExtent();
  import_->SetDataSpacing(array.spacing_mm, array.spacing_mm, array.spacing_mm);
  import_->SetDataOrigin(array.origin_mm.x(), array.origin_mm.y(), array.origin_mm.z());
  import_->Update();
  reslice_->SetInputConnection(import_->GetOutputPort());
  reslice_->SetNumberOfThreads(threads);
  reslice_->SetOutputDimensionality(2);
  reslice_->SetBackgroundLevel(0);
}

ConstPixels VtkSlab::render(const ReslicePlane& plane, const RenderSettings& settings) {
  for (int row = 0; row < 3; ++row) {
    axes_->SetElement(row, 0, plane.right.v[row]);
    axes_->SetElement(row, 1, plane.down.v[row]);
    axes_->SetElement(row, 2, plane.normal().v[row]);
    axes_->SetElement(row, 3, plane.origin.v[row]);
  }
  reslice_->SetResliceAxes(axes_);
  reslice_->SetOutputSpacing(plane.pixel_mm, plane.pixel_mm, settings.band.step_mm);
  reslice_->SetOutputOrigin(0, 0, 0);
  reslice_->SetOutputExtent(0, plane.width - 1, 0, plane.height - 1, 0, 0);
  reslice_->SetSlabNumberOfSlices(settings.band.layers());
  reslice_->SetSlabSliceSpacingFraction(1);
  switch (settings.compounding) {
    case Compounding::maximum:
      reslice_->SetSlabModeToMax();
      break;
    case Compounding::minimum:
      reslice_->SetSlabModeToMin();
      break;
    case Compounding::mean:
      reslice_->SetSlabModeToMean();
      break;
  }
  if (settings.interpolation == Interpolation::linear) {
    reslice_->SetInterpolationModeToLinear();
  } else {
    reslice_->SetInterpolationModeToNearestNeighbor();
  }
  reslice_->Modified();
  reslice_->Update();
  vtkImageData* out = reslice_->GetOutput();
  return {static_cast<const std::uint8_t*>(out->GetScalarPointer()), plane.width, plane.height, plane.width};
}

}  // namespace

std::unique_ptr<Peer> make_peer(const VoxelArray& array, int threads) {
  return std::make_unique<VtkSlab>(array, threads);
}

}  // namespace sonoband::bench
