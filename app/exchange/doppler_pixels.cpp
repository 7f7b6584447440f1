#include "app/exchange/doppler_pixels.h"

#include <algorithm>
#include <cassert>

#include "core/image/overlay.h"

namespace sonoband::exchange {

namespace {

doppler::Rgb rgb_at(const std::uint8_t* bytes, std::size_t pixel) {
  return {bytes[3 * pixel], bytes[3 * pixel + 1], bytes[3 * pixel + 2]};
}

}  // namespace

bool shows_flow(const TrackedSequence& s, ConstPixels sector, const doppler::ColourClassifier& classifier) {
  assert(s.components == 3 && s.element_type == ElementType::uint8);
  const auto pixels = static_cast<std::size_t>(s.width) * s.height;
  const auto inside = [&](std::size_t i) {
    return sector.empty() || sector.row(static_cast<int>(i / s.width))[i % s.width] != 0;
  };
  std::size_t counted = 0;
  for (std::size_t i = 0; i < pixels; ++i) counted += inside(i);
  for (int f = 0; f < s.frame_count(); ++f) {
    const std::uint8_t* bytes = s.frame_pixels(f).data();
    std::size_t coloured = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      if (!inside(i)) continue;
      const auto pixel = classifier.classify(rgb_at(bytes, i));
      coloured += pixel.known && doppler::is_colour(pixel.key);
    }
    if (coloured > 0 && coloured * 1000 >= counted) return true;
  }
  return false;
}

Pixels make_doppler(TrackedSequence& s, ConstPixels sector, const doppler::ColourClassifier& classifier,
                    bool moved) {
  assert(s.components == 3 && s.element_type == ElementType::uint8);
  const auto pixels = static_cast<std::size_t>(s.width) * s.height;
  Pixels keys(s.width, s.height);
  Pixels valid(s.width, s.height);
  Pixels grey(s.width, s.height);
  std::vector<int> strange(pixels);  // in how many frames a hue is not on the bar
  OverlayDetector overlay(s.width, s.height);
  std::uint8_t* out = s.pixels.bytes().data();
  const int frames = s.frame_count();
  for (int f = 0; f < frames; ++f) {
    const std::uint8_t* rgb = s.pixels.bytes().data() + 3 * pixels * static_cast<std::size_t>(f);
    classifier.classify(rgb, 3 * std::ptrdiff_t{s.width}, {}, keys.view(), valid.view());
    for (std::size_t i = 0; i < pixels; ++i) {
      grey.view().data[i] = doppler::luma(rgb_at(rgb, i));
      strange[i] += valid.view().data[i] == 0;
    }
    overlay.add(grey.view());
    // At or before where this frame's colours were: they are no longer needed.
    std::copy_n(keys.view().data, pixels, out + pixels * static_cast<std::size_t>(f));
  }
  s.components = 1;

  Pixels mask = both(sector, overlay.mask({}, moved).view());
  for (std::size_t i = 0; i < pixels; ++i)
    if (2 * strange[i] >= frames) mask.view().data[i] = 0;
  return mask;
}

}  // namespace sonoband::exchange
