#include "core/image/overlay.h"

#include <algorithm>
#include <cassert>

namespace sonoband {
namespace {

void clear_around(ImageView<std::uint8_t> mask, int x, int y, int reach) {
  for (int v = std::max(0, y - reach); v <= std::min(mask.height - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(mask.width - 1, x + reach); ++u) mask(u, v) = 0;
  }
}

}  // namespace

OverlayDetector::OverlayDetector(int width, int height) : least_(width, height), greatest_(width, height) {
  std::fill_n(least_.view().data, static_cast<std::size_t>(width) * height, std::uint8_t{255});
}

void OverlayDetector::add(ConstPixels pixels, const std::array<std::uint8_t, 256>& grey_of) {
  assert(pixels.width == least_.width() && pixels.height == least_.height());
  for (int y = 0; y < pixels.height; ++y) {
    const std::uint8_t* in = pixels.row(y);
    std::uint8_t* least = least_.view().row(y);
    std::uint8_t* greatest = greatest_.view().row(y);
    for (int x = 0; x < pixels.width; ++x) {
      const std::uint8_t grey = grey_of[in[x]];
      least[x] = std::min(least[x], grey);
      greatest[x] = std::max(greatest[x], grey);
    }
  }
  ++frames_;
}

void OverlayDetector::add(ConstPixels grey) {
  static constexpr auto itself = [] {
    std::array<std::uint8_t, 256> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
    return all;
  }();
  add(grey, itself);
}

void OverlayDetector::add_keys(ConstPixels keys) {
  static constexpr auto grey_of = [] {
    std::array<std::uint8_t, 256> all{};
    for (std::size_t key = 0; key < 128; ++key) all[key] = static_cast<std::uint8_t>((key * 255 + 63) / 127);
    return all;
  }();
  add(keys, grey_of);
}

Pixels OverlayDetector::mask(const OverlayRule& rule, bool moved) const {
  Pixels result(least_.width(), least_.height());
  const ImageView<std::uint8_t> mask = result.view();
  for (int y = 0; y < mask.height; ++y) std::fill_n(mask.row(y), mask.width, std::uint8_t{255});
  if (!moved || frames_ < rule.least_frames) return result;
  const ConstPixels least = least_.view();
  const ConstPixels greatest = greatest_.view();
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const bool drawn = least(x, y) >= rule.brightness && greatest(x, y) - least(x, y) <= rule.tolerance;
      if (drawn) clear_around(mask, x, y, rule.grow_px);
    }
  }
  return result;
}

Pixels both(ConstPixels a, ConstPixels b) {
  if (a.empty() && b.empty()) return {};
  if (a.empty()) return both(b, a);
  assert(b.empty() || (a.width == b.width && a.height == b.height));
  Pixels result(a.width, a.height);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      result.view()(x, y) = a(x, y) != 0 && (b.empty() || b(x, y) != 0) ? 255 : 0;
    }
  }
  return result;
}

}  // namespace sonoband
