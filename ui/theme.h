// Colours and sizes. Dark room: dark grounds, one accent; red is for recording and for what needs action.
#pragma once

#include <cstdint>

#include "ui/rect.h"

namespace sonoband::ui {

// 0xRRGGBBAA
struct Colour {
  std::uint32_t rgba = 0;
  constexpr Colour with_alpha(float alpha) const {
    const float rounded = alpha * 255 + 0.5f;
    return {(rgba & 0xffffff00u) | static_cast<std::uint32_t>(rounded)};
  }
  bool operator==(const Colour&) const = default;
};

namespace colour {
constexpr Colour ground{0x0b0e13ff};
constexpr Colour rail{0x0e1218ff};
constexpr Colour panel{0x161b23ff};
constexpr Colour raised{0x222a36ff};  // buttons at rest, sliders' grooves
constexpr Colour pressed{0x334052ff};
constexpr Colour border{0x313b49ff};
constexpr Colour picture{0x000000ff};
constexpr Colour no_data{0x1b2533ff};  // must not be mistaken for black, which is a grey level
constexpr Colour ink{0xf2f5f9ff};
constexpr Colour ink_quiet{0x9fabbaff};  // 6.9 : 1 on `panel`
constexpr Colour ink_on_accent{0x06131dff};
constexpr Colour accent{0x4cc2ffff};
constexpr Colour accent_ground{0x1d3646ff};
constexpr Colour good{0x46c35aff};
constexpr Colour warning{0xf0b23dff};
constexpr Colour alarm{0xff544bff};
constexpr Colour plane{0x3ec46dff};    // the reslice plane, in every window
constexpr Colour current{0xff6b5eff};  // the B-scan shown in Review, in every window (paper, Figure 2)
constexpr Colour smeared{0xf0b23dff};
constexpr Colour landmark{0xffd75eff};
constexpr Colour measure{0xf58be8ff};
constexpr Colour contour{0x7ce0c3ff};
constexpr Colour shade{0x000000b0};  // over what a sheet covers
}  // namespace colour

enum class Type : std::uint8_t { small, body, strong, title, large };

// How big things are on this panel.
struct Metrics {
  Rect screen;             // all pixels
  float unit = 1;          // pixels per layout unit; 1 on a 10.1 inch 1280 x 800 panel at scale 1
  float target = 54;       // least side of what a finger must hit, pixels: 9 mm of the panel
  float px_per_mm = 5.9f;  // of the panel: 5.9 is 150 dots per inch

  float px(float units) const { return units * unit; }
};

// `width_mm` of the panel's picture area; 0 or less: unknown, taken as 150 dots per inch, which a 10.1 inch
// 1280 x 800 and a 14.7 inch 1920 x 1080 panel have. `scale` multiplies type and spacing (usual 1; 1.5 for a
// screen looked at from afar). The unit is held between limits within which every screen can be laid out.
Metrics metrics_for(int width_px, int height_px, float width_mm, float scale);

}  // namespace sonoband::ui
