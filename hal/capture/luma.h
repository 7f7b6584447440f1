// From a raw capture to the cropped grey picture in MF orientation: the only place where pixels are flipped,
// cropped or stripped of colour. Straight into where it is kept, in one pass.
#pragma once

#include <cstdint>

#include "core/image/image.h"
#include "hal/devices.h"

namespace sonoband {

// The crop's size is that of the picture it goes to. Flips are of the crop, not of the whole capture: they
// make MF (x to the marked side, y away from the probe) of MN, UF and UN.
struct Crop {
  int x = 0;  // left upper corner, in pixels of the raw capture
  int y = 0;
  bool flip_x = false;  // for UF, UN
  bool flip_y = false;  // for MN, UN
};

enum class FrameFault : std::uint8_t {
  none,
  format,  // not one that luma is taken from here (mjpeg is decoded by its source)
  size,    // another size than expected, or fewer bytes than rows of that size need
};

// Every number of a frame comes from a device: this is what copy_luma relies on.
FrameFault check_frame(const Frame& frame, int width, int height);

// Preconditions: check_frame() gave none for the frame's own width and height, and the crop lies within them
// (asserted). YUYV, UYVY and NV12 give their Y as it is; rgb24 gives (77 R + 150 G + 29 B + 128) / 256,
// BT.601 with weights that keep grey exactly.
void copy_luma(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out);

}  // namespace sonoband
