#include "tests/figures/drawn_lines.h"

#include <algorithm>
#include <cmath>

namespace sonoband::figures {
namespace {

void to_rgb(exchange::PngPicture& picture) {
  if (picture.channels == 3) return;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * picture.bytes.size());
  for (const std::uint8_t grey : picture.bytes) rgb.insert(rgb.end(), 3, grey);
  picture.bytes = std::move(rgb);
  picture.channels = 3;
}

}  // namespace

void draw_line(exchange::PngPicture& picture, const PlaneLine& line, double pixel_mm, doppler::Rgb colour) {
  to_rgb(picture);
  for (std::size_t i = 1; i < line.size(); ++i) {
    const PlanePoint from = line[i - 1] / pixel_mm, to = line[i] / pixel_mm;
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).cwiseAbs().maxCoeff())));
    for (int s = 0; s <= steps; ++s) {
      const PlanePoint at = from + (to - from) * s / steps;
      const long x = std::lround(at.x()), y = std::lround(at.y());
      if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
      std::uint8_t* pixel = &picture.bytes[3 * static_cast<std::size_t>(y * picture.width + x)];
      pixel[0] = colour.r;
      pixel[1] = colour.g;
      pixel[2] = colour.b;
    }
  }
}

}  // namespace sonoband::figures
