// From a raw capture to the cropped grey picture in MF orientation: the only place where pixels are flipped,
// cropped or stripped of colour.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"
#include "core/sweep/loss_ledger.h"
#include "hal/devices.h"

namespace sonoband::cart {

// The crop's size is that of the ring's pictures. Flips are of the crop, not of the whole capture: they make
// MF (x to the marked side, y away from the probe) of MN, UF and UN.
struct Crop {
  int x = 0;  // left upper corner, in pixels of the raw capture
  int y = 0;
  bool flip_x = false;  // for UF, UN
  bool flip_y = false;  // for MN, UN
};

// Why this capture cannot be used: a format other than grey8 and rgb24, another size than expected (the
// scanner changed its mode), or fewer bytes than rows of that size need. Empty: it can.
std::optional<LossCause> unusable(const Frame& frame, int width, int height);

// Preconditions: unusable() gave nothing, and the crop lies within the frame (asserted). rgb24 gives luma,
// (77 R + 150 G + 29 B + 128) / 256, BT.601 with weights that keep grey exactly.
void copy_luma(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out);

// Whether the sum of |a - b| over two pictures of one size is below `limit`. Stops at the row where it is
// not, so that only a repeated picture costs a whole pass.
bool differ_less(ConstPixels a, ConstPixels b, std::uint64_t limit);

}  // namespace sonoband::cart
