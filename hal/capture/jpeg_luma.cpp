#include "hal/capture/jpeg_luma.h"

#include <turbojpeg.h>

#include <limits>
#include <new>

namespace sonoband {
namespace {

// Cut-off pictures come out with a warning and a grey rest: they are refused.
constexpr int whole_only = TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING;

}  // namespace

JpegLuma::JpegLuma() : handle_(tjInitDecompress()) {
  if (handle_ == nullptr) throw std::bad_alloc();
}

JpegLuma::~JpegLuma() {
  tjDestroy(handle_);
}

// Before anything is decoded: a picture of another size would cost what it likes.
bool JpegLuma::is_of_size(std::span<const std::uint8_t> jpeg, int width, int height) {
  if (jpeg.empty() || jpeg.size() > std::numeric_limits<unsigned>::max()) return false;
  int found_width = 0;
  int found_height = 0;
  int subsampling = 0;
  int colours = 0;
  const auto size = static_cast<unsigned long>(jpeg.size());
  return tjDecompressHeader3(handle_, jpeg.data(), size, &found_width, &found_height, &subsampling,
                             &colours) == 0 &&
         found_width == width && found_height == height;
}

bool JpegLuma::decode(std::span<const std::uint8_t> jpeg, ImageView<std::uint8_t> out) {
  return is_of_size(jpeg, out.width, out.height) &&
         tjDecompress2(handle_, jpeg.data(), static_cast<unsigned long>(jpeg.size()), out.data, out.width,
                       static_cast<int>(out.stride), out.height, TJPF_GRAY, whole_only) == 0;
}

bool JpegLuma::decode_rgb(std::span<const std::uint8_t> jpeg, int width, int height, std::uint8_t* out) {
  return is_of_size(jpeg, width, height) &&
         tjDecompress2(handle_, jpeg.data(), static_cast<unsigned long>(jpeg.size()), out, width, 3 * width,
                       height, TJPF_RGB, whole_only) == 0;
}

}  // namespace sonoband
