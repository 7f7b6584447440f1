// What acquisition asks of a raw capture; hal/capture/luma.h makes the picture of it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"
#include "core/sweep/loss_ledger.h"
#include "hal/capture/flow_keys.h"
#include "hal/capture/luma.h"
#include "hal/devices.h"

namespace sonoband::cart {

// The crop's size is that of the ring's pictures.
using sonoband::copy_luma;
using sonoband::Crop;
using sonoband::FlowKeys;

// Why this capture cannot be used: a format without luma, another size than expected (the scanner changed its
// mode), or fewer bytes than rows of that size need. Empty: it can.
std::optional<LossCause> unusable(const Frame& frame, int width, int height);

// Whether the sum of |a - b| over two pictures of one size is below `limit`. Stops at the row where it is
// not, so that only a repeated picture costs a whole pass.
bool differ_less(ConstPixels a, ConstPixels b, std::uint64_t limit);

}  // namespace sonoband::cart
