#include "hal/capture/flow_keys.h"

#include <algorithm>
#include <cassert>

namespace sonoband {
namespace {

constexpr int cells = 32;  // per channel: 8 levels wide
constexpr std::int16_t is_grey = -1;

std::size_t cell_of(int y, int u, int v) {
  return (static_cast<std::size_t>(y / 8) * cells + static_cast<std::size_t>(u / 8)) * cells +
         static_cast<std::size_t>(v / 8);
}

// BT.601, limited range.
doppler::Rgb rgb_of(int y, int u, int v) {
  const double light = 255.0 / 219 * (y - 16);
  const double blue = 255.0 / 224 * (u - 128);
  const double red = 255.0 / 224 * (v - 128);
  const auto level = [](double x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5, 0.0, 255.0)); };
  return {level(light + 1.402 * red), level(light - 0.344136 * blue - 0.714136 * red),
          level(light + 1.772 * blue)};
}

}  // namespace

FlowKeys::FlowKeys(const doppler::ColourClassifier& classifier)
    : classifier_(classifier), colour_of_cell_(static_cast<std::size_t>(cells) * cells * cells) {
  for (int grey = 0; grey < 256; ++grey) {
    const auto g = static_cast<std::uint8_t>(grey);
    grey_[g] = classifier.classify({g, g, g}).key;
  }
  for (int y = 4; y < 256; y += 8) {
    for (int u = 4; u < 256; u += 8) {
      for (int v = 4; v < 256; v += 8) {
        const auto pixel = classifier.classify(rgb_of(y, u, v));
        const bool grey = pixel.known && !doppler::is_colour(pixel.key);
        colour_of_cell_[cell_of(y, u, v)] = grey ? is_grey : pixel.key;
      }
    }
  }
}

std::uint8_t FlowKeys::key_of_yuv(int y, int u, int v) const {
  const std::int16_t key = colour_of_cell_[cell_of(y, u, v)];
  return key == is_grey ? grey_[static_cast<std::size_t>(y)] : static_cast<std::uint8_t>(key);
}

// `row` of the frame, from its pixel `from_x` on.
void FlowKeys::copy_row(const Frame& frame, int from_x, const std::uint8_t* row,
                        ImageView<std::uint8_t> out) const {
  std::uint8_t* to = out.data;
  const auto pairs = [&](int luma, int chroma) {
    const int whole = frame.width & ~1;  // half a pair at the end has no second chroma
    for (int x = 0; x < out.width; ++x) {
      const int at = from_x + x;
      const std::uint8_t* pair = row + 2 * (at & ~1);
      const int y = row[2 * at + luma];
      to[x] = at < whole ? key_of_yuv(y, pair[chroma], pair[chroma + 2]) : grey_[static_cast<std::size_t>(y)];
    }
  };
  switch (frame.format) {
    case PixelFormat::rgb24:
      for (int x = 0; x < out.width; ++x) {
        const std::uint8_t* rgb = row + 3 * (from_x + x);
        to[x] = classifier_.classify({rgb[0], rgb[1], rgb[2]}).key;
      }
      break;
    case PixelFormat::yuyv:
      return pairs(0, 1);
    case PixelFormat::uyvy:
      return pairs(1, 0);
    default:
      for (int x = 0; x < out.width; ++x) to[x] = grey_[row[from_x + x]];
      break;
  }
}

void FlowKeys::copy(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out) const {
  assert(check_frame(frame, frame.width, frame.height) == FrameFault::none);
  assert(crop.x >= 0 && crop.y >= 0 && crop.x + out.width <= frame.width &&
         crop.y + out.height <= frame.height);
  for (int y = 0; y < out.height; ++y) {
    const int from_y = crop.y + (crop.flip_y ? out.height - 1 - y : y);
    std::uint8_t* to = out.row(y);
    copy_row(frame, crop.x, frame.data + from_y * frame.stride_bytes, {to, out.width, 1, out.stride});
    if (crop.flip_x) std::reverse(to, to + out.width);
  }
}

}  // namespace sonoband
