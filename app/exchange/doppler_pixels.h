// Colour Doppler from a recording of the scanner's screen: RGB pixels to the ordered keys of
// core/image/doppler.h.
#pragma once

#include "app/exchange/sequence.h"
#include "core/image/colour_bar.h"

namespace sonoband::exchange {

// Whether any frame of an 8-bit RGB recording has a thousandth of the sector's pixels (empty: all pixels) in
// a colour of the classifier's bar.
bool shows_flow(const TrackedSequence& rgb, ConstPixels sector, const doppler::ColourClassifier& classifier);

// In place, so that a large recording is never held twice. Returns the pixels that are ultrasound throughout:
// those of the sector but for what the scanner draws and never moves (the white box, text), looked for only
// where the probe `moved`, and but for places that show a hue that is not on the bar in at least half of the
// frames. Where such a hue only passes, that pixel of that frame is the darkest grey.
// Precondition: 8-bit RGB.
Pixels make_doppler(TrackedSequence& rgb, ConstPixels sector, const doppler::ColourClassifier& classifier,
                    bool moved);

}  // namespace sonoband::exchange
