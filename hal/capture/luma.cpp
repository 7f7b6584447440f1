#include "hal/capture/luma.h"

#include <algorithm>
#include <cassert>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hal/capture/luma.cpp"
#include <hwy/foreach_target.h>
// Highway's per-target headers come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sonoband {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Every second byte, from byte `first` (0 or 1) of the first pair on.
HWY_ATTR void every_second(const std::uint8_t* pairs, int first, std::uint8_t* out, int width) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    hn::VFromD<decltype(d)> even;
    hn::VFromD<decltype(d)> odd;
    hn::LoadInterleaved2(d, pairs + 2 * x, even, odd);
    hn::StoreU(first == 0 ? even : odd, d, out + x);
  }
  for (; x < width; ++x) out[x] = pairs[2 * x + first];
}

}  // namespace HWY_NAMESPACE
}  // namespace sonoband
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sonoband {
namespace {

HWY_EXPORT(every_second);

// Of the plane that holds luma.
std::ptrdiff_t bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb24:
      return 3;
    case PixelFormat::yuyv:
    case PixelFormat::uyvy:
      return 2;
    default:
      return 1;
  }
}

std::uint8_t luma(const std::uint8_t* rgb) {
  return static_cast<std::uint8_t>((77 * rgb[0] + 150 * rgb[1] + 29 * rgb[2] + 128) >> 8);
}

}  // namespace

FrameFault check_frame(const Frame& frame, int width, int height) {
  if (frame.format == PixelFormat::mjpeg) return FrameFault::format;
  if (frame.data == nullptr || width < 1 || height < 1 || frame.width != width || frame.height != height)
    return FrameFault::size;
  const std::ptrdiff_t row = bytes_per_pixel(frame.format) * width;
  if (frame.stride_bytes < row) return FrameFault::size;
  // Division, because a wild stride times the height may overflow.
  const auto bytes = static_cast<std::ptrdiff_t>(
      std::min<std::size_t>(frame.bytes, std::numeric_limits<std::ptrdiff_t>::max()));
  if (bytes < row || (height > 1 && (bytes - row) / (height - 1) < frame.stride_bytes))
    return FrameFault::size;
  return FrameFault::none;
}

void copy_luma(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out) {
  assert(check_frame(frame, frame.width, frame.height) == FrameFault::none);
  assert(crop.x >= 0 && crop.y >= 0 && crop.x + out.width <= frame.width &&
         crop.y + out.height <= frame.height);
  const std::ptrdiff_t pixel = bytes_per_pixel(frame.format);
  for (int y = 0; y < out.height; ++y) {
    const int from_y = crop.y + (crop.flip_y ? out.height - 1 - y : y);
    const std::uint8_t* from = frame.data + from_y * frame.stride_bytes + crop.x * pixel;
    std::uint8_t* to = out.row(y);
    switch (frame.format) {
      case PixelFormat::rgb24:
        for (int x = 0; x < out.width; ++x) to[x] = luma(from + 3 * x);
        break;
      case PixelFormat::yuyv:
        HWY_DYNAMIC_DISPATCH(every_second)(from, 0, to, out.width);
        break;
      case PixelFormat::uyvy:
        HWY_DYNAMIC_DISPATCH(every_second)(from, 1, to, out.width);
        break;
      default:
        std::copy_n(from, out.width, to);
        break;
    }
    if (crop.flip_x) std::reverse(to, to + out.width);
  }
}

}  // namespace sonoband
#endif
