#include "app/exchange/volume.h"

#include <cassert>

#include "app/exchange/text.h"

namespace sonoband::exchange {

VolumeWriter::VolumeWriter(const std::filesystem::path& path, const VoxelLattice& lattice,
                           const std::string& comment)
    : file_(path), lattice_(lattice) {
  const auto three = [](const auto& values) {
    return format_number(values[0]) + " " + format_number(values[1]) + " " + format_number(values[2]);
  };
  const std::array<double, 3> spacing{lattice.spacing_mm, lattice.spacing_mm, lattice.spacing_mm};
  file_.stream() << "ObjectType = Image\nNDims = 3\nAnatomicalOrientation = RAI\nBinaryData = True\n"
                    "BinaryDataByteOrderMSB = False\nCenterOfRotation = 0 0 0\nCompressedData = False\n"
                 << "Comment = " << comment << "\nDimSize = " << lattice.dims[0] << ' ' << lattice.dims[1]
                 << ' ' << lattice.dims[2]
                 << "\nElementNumberOfChannels = 1\nElementSpacing = " << three(spacing)
                 << "\nElementType = MET_UCHAR\nKinds = domain domain domain\nOffset = "
                 << three(lattice.origin_mm)
                 << "\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nUltrasoundImageOrientation = MFA\n"
                    "UltrasoundImageType = BRIGHTNESS\nElementDataFile = LOCAL\n";
}

void VolumeWriter::write_slice(ConstPixels slice) {
  assert(slice.width == lattice_.dims[0] && slice.height == lattice_.dims[1] && written_ < lattice_.dims[2]);
  for (int y = 0; y < slice.height; ++y)
    file_.stream().write(reinterpret_cast<const char*>(slice.row(y)), slice.width);
  ++written_;
}

void VolumeWriter::finish() {
  assert(written_ == lattice_.dims[2]);
  file_.commit();
}

}  // namespace sonoband::exchange
