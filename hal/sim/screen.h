// What the simulated scanner's screen shows beside echoes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/sim/scanner.h"

namespace sonoband::sim {

// Signed level -63..63 to the screen's colour: towards the probe dark red to yellow, away dark blue to cyan.
void flow_colour(int level, std::uint8_t rgb[3]);

// Draws over a picture: depth ticks, a grey bar, letters (settings.decorations), the colour bar and the white
// box round the region of colour.
void draw_screen(const ScannerSettings& settings, std::uint8_t* pixels, std::ptrdiff_t stride_bytes);

}  // namespace sonoband::sim
