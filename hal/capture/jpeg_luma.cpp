#include "hal/capture/jpeg_luma.h"

#include <turbojpeg.h>

#include <limits>
#include <new>

namespace sonoband {

JpegLuma::JpegLuma() : handle_(tjInitDecompress()) {
  if (handle_ == nullptr) throw std::bad_alloc();
}

JpegLuma::~JpegLuma() {
  tjDestroy(handle_);
}

bool JpegLuma::decode(std::span<const std::uint8_t> jpeg, ImageView<std::uint8_t> out) {
  if (jpeg.empty() || jpeg.size() > std::numeric_limits<unsigned>::max()) return false;
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  const auto size = static_cast<unsigned long>(jpeg.size());
  if (tjDecompressHeader3(handle_, jpeg.data(), size, &width, &height, &subsampling, &colours) != 0)
    return false;
  // Before anything is decoded: a picture of another size would cost what it likes.
  if (width != out.width || height != out.height) return false;
  // Cut-off pictures come out with a warning and a grey rest: they are refused.
  return tjDecompress2(handle_, jpeg.data(), size, out.data, out.width, static_cast<int>(out.stride),
                       out.height, TJPF_GRAY, TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING) == 0;
}

}  // namespace sonoband
