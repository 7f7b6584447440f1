#include "core/image/colour_bar.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sonoband::doppler {
namespace {

constexpr int cells = 32;  // per channel: 8 grey levels wide

std::size_t cell_of(Rgb c) {
  return (static_cast<std::size_t>(c.r / 8) * cells + c.g / 8) * cells + c.b / 8;
}

int squared_distance(Rgb a, Rgb b) {
  const int dr = a.r - b.r;
  const int dg = a.g - b.g;
  const int db = a.b - b.b;
  return dr * dr + dg * dg + db * db;
}

// The bar's nearest colour; of equally near ones the lowest level, red before blue.
std::int16_t nearest_key(Rgb c, const ColourBar& bar, int limit_squared, std::int16_t none) {
  std::int16_t key = none;
  int best = limit_squared + 1;
  for (int level = 0; level < level_count; ++level) {
    for (const bool red : {true, false}) {
      const int d = squared_distance(c, (red ? bar.red : bar.blue)[level]);
      if (d >= best) continue;
      best = d;
      key = colour_key(level, red);
    }
  }
  return key;
}

std::uint8_t grey7(Rgb c) {
  return static_cast<std::uint8_t>((luma(c) * 127 + 127) / 255);
}

}  // namespace

std::array<Rgb, level_count> ramp(std::span<const Rgb> colours) {
  assert(colours.size() >= 2);
  std::array<Rgb, level_count> levels{};
  for (int level = 0; level < level_count; ++level) {
    const double place =
        static_cast<double>(level) * static_cast<double>(colours.size() - 1) / (level_count - 1);
    const auto before = std::min(static_cast<std::size_t>(place), colours.size() - 2);
    const double part = place - static_cast<double>(before);
    const auto mix = [part](std::uint8_t a, std::uint8_t b) {
      return static_cast<std::uint8_t>(std::lround(a + part * (b - a)));
    };
    const Rgb& a = colours[before];
    const Rgb& b = colours[before + 1];
    levels[level] = {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
  }
  return levels;
}

ColourBar red_blue_bar() {
  ColourBar bar;
  for (int level = 0; level < level_count; ++level) {
    // Half of the ramp brightens the pure colour from 64, the other half turns it towards yellow or cyan.
    const int half = level_count / 2;
    const auto pure = static_cast<std::uint8_t>(level < half ? 64 + level * 191 / (half - 1) : 255);
    const auto turn = static_cast<std::uint8_t>(level < half ? 0 : (level - half + 1) * 255 / half);
    bar.red[level] = {pure, turn, 0};
    bar.blue[level] = {0, turn, pure};
  }
  return bar;
}

Rgb to_rgb(std::uint8_t key, const ColourBar& bar) {
  if (!is_colour(key)) {
    const auto grey = static_cast<std::uint8_t>((key * 255 + 63) / 127);
    return {grey, grey, grey};
  }
  return ((key & 1) != 0 ? bar.red : bar.blue)[(key - 128) / 2];
}

ColourClassifier::ColourClassifier(const ColourBar& bar, const ColourThresholds& thresholds)
    : thresholds_(thresholds), key_of_cell_(static_cast<std::size_t>(cells) * cells * cells) {
  const int limit_squared = thresholds.hue_distance * thresholds.hue_distance;
  for (int r = 0; r < cells; ++r) {
    for (int g = 0; g < cells; ++g) {
      for (int b = 0; b < cells; ++b) {
        const auto centre = [](int cell) { return static_cast<std::uint8_t>(cell * 8 + 4); };
        const Rgb c{centre(r), centre(g), centre(b)};
        key_of_cell_[cell_of(c)] = nearest_key(c, bar, limit_squared, unknown);
      }
    }
  }
}

ColourClassifier::Pixel ColourClassifier::classify(Rgb c) const {
  const int brightest = std::max({c.r, c.g, c.b});
  const int chroma = brightest - std::min({c.r, c.g, c.b});
  if (chroma < thresholds_.chroma || brightest < thresholds_.luminance) return {grey7(c), true};
  const std::int16_t key = key_of_cell_[cell_of(c)];
  if (key == unknown) return {0, false};
  return {static_cast<std::uint8_t>(key), true};
}

void ColourClassifier::classify(const std::uint8_t* rgb, std::ptrdiff_t stride_bytes, ConstPixels sector,
                                ImageView<std::uint8_t> keys, ImageView<std::uint8_t> valid) const {
  assert(sector.empty() || (sector.width == keys.width && sector.height == keys.height));
  for (int y = 0; y < keys.height; ++y) {
    const std::uint8_t* in = rgb + y * stride_bytes;
    for (int x = 0; x < keys.width; ++x) {
      const Rgb c{in[3 * x], in[3 * x + 1], in[3 * x + 2]};
      Pixel pixel{0, false};
      if (sector.empty() || sector(x, y) != 0) pixel = classify(c);
      keys(x, y) = pixel.key;
      if (!valid.empty()) valid(x, y) = pixel.known ? 255 : 0;
    }
  }
}

}  // namespace sonoband::doppler
