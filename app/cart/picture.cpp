#include "app/cart/picture.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <limits>

namespace sonoband::cart {
namespace {

std::ptrdiff_t bytes_per_pixel(PixelFormat format) {
  return format == PixelFormat::rgb24 ? 3 : 1;
}

std::uint8_t luma(const std::uint8_t* rgb) {
  return static_cast<std::uint8_t>((77 * rgb[0] + 150 * rgb[1] + 29 * rgb[2] + 128) >> 8);
}

}  // namespace

std::optional<LossCause> unusable(const Frame& frame, int width, int height) {
  if (frame.format != PixelFormat::grey8 && frame.format != PixelFormat::rgb24) return LossCause::bad_format;
  const std::ptrdiff_t row = bytes_per_pixel(frame.format) * width;
  if (frame.data == nullptr || frame.width != width || frame.height != height || frame.stride_bytes < row)
    return LossCause::bad_size;
  // Division, because a wild stride times the height may overflow.
  const auto bytes = static_cast<std::ptrdiff_t>(
      std::min<std::size_t>(frame.bytes, std::numeric_limits<std::ptrdiff_t>::max()));
  if (bytes < row || (height > 1 && (bytes - row) / (height - 1) < frame.stride_bytes))
    return LossCause::bad_size;
  return std::nullopt;
}

void copy_luma(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out) {
  assert(crop.x >= 0 && crop.y >= 0 && crop.x + out.width <= frame.width &&
         crop.y + out.height <= frame.height);
  const std::ptrdiff_t pixel = bytes_per_pixel(frame.format);
  for (int y = 0; y < out.height; ++y) {
    const int from_y = crop.y + (crop.flip_y ? out.height - 1 - y : y);
    const std::uint8_t* from = frame.data + from_y * frame.stride_bytes + crop.x * pixel;
    std::uint8_t* to = out.row(y);
    if (pixel == 1) {
      std::copy_n(from, out.width, to);
    } else {
      for (int x = 0; x < out.width; ++x) to[x] = luma(from + 3 * x);
    }
    if (crop.flip_x) std::reverse(to, to + out.width);
  }
}

bool differ_less(ConstPixels a, ConstPixels b, std::uint64_t limit) {
  assert(a.width == b.width && a.height == b.height);
  std::uint64_t sum = 0;
  for (int y = 0; y < a.height && sum < limit; ++y) {
    const std::uint8_t* pa = a.row(y);
    const std::uint8_t* pb = b.row(y);
    std::uint32_t row = 0;
    for (int x = 0; x < a.width; ++x) row += static_cast<std::uint32_t>(std::abs(pa[x] - pb[x]));
    sum += row;
  }
  return sum < limit;
}

}  // namespace sonoband::cart
