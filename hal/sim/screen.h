// What the simulated scanner's screen shows beside echoes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/image/colour_bar.h"
#include "hal/sim/scanner.h"

namespace sonoband::sim {

// Signed level, not 0, -63..63: towards the probe the bar's red ramp, away its blue one.
doppler::Rgb flow_colour(const doppler::ColourBar& bar, int level);

// Draws over a picture: depth ticks, a grey bar, letters (settings.decorations), the colour bar and the white
// box round the region of colour.
void draw_screen(const ScannerSettings& settings, const doppler::ColourBar& bar, std::uint8_t* pixels,
                 std::ptrdiff_t stride_bytes);

}  // namespace sonoband::sim
