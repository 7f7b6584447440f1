// Colour Doppler between a scanner's screen (RGB) and the ordered keys of core/image/doppler.h.
// Sources: Stradx file format (two ramps, dark blue to cyan and dark red to yellow); chroma and luminance
// thresholds as Stradx and Stradwin use them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/image/doppler.h"
#include "core/image/image.h"

namespace sonoband::doppler {

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

// Rec. 601 luma of full-range RGB, rounded: what a grey pixel of the screen means.
constexpr std::uint8_t luma(Rgb c) {
  return static_cast<std::uint8_t>((299 * c.r + 587 * c.g + 114 * c.b + 500) / 1000);
}

// The scanner's bar: one ramp of colours for each direction of flow, dark (level 0) to bright (level 63).
struct ColourBar {
  std::array<Rgb, level_count> red;   // flow towards the probe: positive velocity
  std::array<Rgb, level_count> blue;  // away from it
};

// One direction of a bar: at least two colours (asserted), dark to bright, evenly spaced over the levels;
// straight lines in RGB between them.
std::array<Rgb, level_count> ramp(std::span<const Rgb> colours);

// Dark red over red to yellow, dark blue over blue to cyan: the commonest bar.
ColourBar red_blue_bar();

// What the screen shows for a key: 7-bit grey stretched to 8, or the bar's colour.
Rgb to_rgb(std::uint8_t key, const ColourBar& bar);

// Usual values for 8-bit uncompressed capture; raise chroma to about 30 for MJPEG.
struct ColourThresholds {
  int chroma = 24;        // largest minus smallest of r, g, b from which a pixel is coloured
  int luminance = 40;     // brightest channel below which hue is noise and the pixel grey; not luma, which
                          // counts blue at 0.11 and would lose the slower half of the blue ramp
  int hue_distance = 72;  // farther than this (RGB, Euclidean) from every colour of the bar: not a velocity
};

// RGB to key by one table look-up a pixel. The table has 32 steps per channel, so a level is right within
// about 4 of 64.
class ColourClassifier {
 public:
  ColourClassifier(const ColourBar& bar, const ColourThresholds& thresholds);

  struct Pixel {
    std::uint8_t key = 0;
    bool known =
        true;  // false: a colour that is not on the bar (turbulence green, orange text); to be masked
  };
  Pixel classify(Rgb c) const;

  // `rgb` holds 3 bytes a pixel, rows stride_bytes apart, as large as `keys`. Pixels outside `sector` (zero
  // there; empty: none are) and pixels of unknown hue get key 0 and `valid` 0; the others `valid` 255.
  // `valid` may be empty.
  void classify(const std::uint8_t* rgb, std::ptrdiff_t stride_bytes, ConstPixels sector,
                ImageView<std::uint8_t> keys, ImageView<std::uint8_t> valid) const;

 private:
  static constexpr int unknown = -1;
  ColourThresholds thresholds_;
  std::vector<std::int16_t> key_of_cell_;  // 32 x 32 x 32, or unknown
};

}  // namespace sonoband::doppler
