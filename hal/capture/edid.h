// What an HDMI bridge tells the scanner about the "display" it is: a scanner sends nothing to a bridge that
// has told it nothing.
#pragma once

#include <array>
#include <cstdint>

namespace sonoband {

// 128 bytes of EDID 1.4 with one detailed timing, the preferred and only one but for the 640 x 480 that every
// display takes: `width` x `height` progressive at `rate_hz`. Blanking is the standard's where there is a
// standard (1920 x 1080 and 1280 x 720 of CEA-861), else that of VESA's reduced blanking. Sides from 16 to
// 4095, and a pixel clock of at most 655 MHz; empty (all 0) beyond.
std::array<std::uint8_t, 128> edid(int width, int height, double rate_hz);

}  // namespace sonoband
