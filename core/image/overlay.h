// What the scanner draws over the picture and never moves: the box round the Doppler region, text, calipers.
// Left in, it is brighter than most tissue and leaves a white wall in every maximum (the paper's Figure 6b
// has it).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image/image.h"

namespace sonoband {

struct OverlayRule {
  int tolerance = 12;  // grey levels a drawn pixel may flicker over a sweep; speckle varies by more than 40
  int brightness =
      110;  // darkest level of a drawing; constant and darker is shadow, fluid or background, and stays
  int grow_px = 1;       // capture blurs a line by about a pixel on each side
  int least_frames = 8;  // below this a still probe looks like a drawing, so nothing is called one
};

// Collects the range of every pixel over a sweep; memory is two bytes a pixel, allocated once.
class OverlayDetector {
 public:
  OverlayDetector(int width, int height);

  void add(ConstPixels grey);  // same size as constructed with (asserted)
  // Of a Doppler picture, whose greys have 7 bits: what is coloured flows, and is no drawing.
  void add_keys(ConstPixels keys);

  // 255 where a pixel is ultrasound, 0 where it is drawn. `moved` says whether the probe moved during the
  // sweep; if it did not, constancy proves nothing and all pixels count as ultrasound.
  Pixels mask(const OverlayRule& rule, bool moved) const;

 private:
  void add(ConstPixels pixels, const std::array<std::uint8_t, 256>& grey_of);

  Pixels least_;
  Pixels greatest_;
  int frames_ = 0;
};

// Pixels that count in both; either may be empty, which is all of them.
Pixels both(ConstPixels a, ConstPixels b);

}  // namespace sonoband
