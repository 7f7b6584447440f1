// Small rings and frames whose pixels tell which frame they are.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/sweep/frame_ring.h"

namespace sonoband::test {

inline Stamp at_ms(double ms) {
  return Stamp(from_seconds(ms / 1000));
}

inline RingSettings small_ring(std::uint32_t slots, std::uint32_t reserve = 3, std::uint32_t sweeps = 3) {
  return {.width = 20, .height = 4, .slots = slots, .reserve = reserve, .sweeps = sweeps, .leases = 2};
}

// Every pixel of frame n has one value that depends on n.
inline std::uint8_t shade_of(std::uint64_t n) {
  return static_cast<std::uint8_t>(n * 37 + 11);
}

inline void fill(RingSlot& slot, std::uint64_t n, Stamp captured) {
  for (int y = 0; y < slot.pixels.height; ++y)
    for (int x = 0; x < slot.pixels.width; ++x) slot.pixels(x, y) = shade_of(n);
  slot.frame.tracked.captured = captured;
  slot.frame.raw.device_sequence = n;
}

inline void pose(RingSlot& slot, double z_mm) {
  Affine<frame::World, frame::Image> world_from_image;
  world_from_image.translation.z() = z_mm;
  set_pose(slot.frame.tracked, world_from_image);
}

inline bool intact(const SweepFrame& f) {
  const ConstPixels& p = f.tracked.bscan.pixels;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      if (p(x, y) != shade_of(f.raw.device_sequence)) return false;
  return true;
}

}  // namespace sonoband::test
