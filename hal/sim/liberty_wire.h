// Frames and texts as a LIBERTY or PATRIOT sends them. Written from the protocol's description apart from
// hal/tracker's decoder, so that an error in one does not hide in the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/sim/liberty_settings.h"

namespace sonoband::sim {

// Fixed room for one record, reply or piece of text.
struct WireBytes {
  static constexpr std::size_t capacity = 1024;
  std::array<std::uint8_t, capacity> data{};
  std::size_t size = 0;

  std::span<const std::uint8_t> view() const { return {data.data(), size}; }
  void byte(std::uint8_t b);
  void u16(std::uint16_t v);
  void u32(std::uint32_t v);
  void f32(float v);
  void text(const char* s);
  void format(const char* pattern, double v);
};

// Begins a frame; finish_frame fills in the size of what was put after it.
void begin_frame(WireBytes& out, liberty::Tag tag, int station, std::uint8_t command, std::uint8_t error);
void finish_frame(WireBytes& out);

// What a record tells, in the unit's own units.
struct WireReading {
  std::array<float, 3> position{};
  std::array<float, 3> angles_deg{};
  std::array<float, 4> quaternion{};
  std::uint32_t time_ms = 0;
  std::uint32_t frame = 0;
  std::int32_t distortion = 0;
};

void put_binary_items(WireBytes& out, const liberty::OutputList& list, const WireReading& reading);
void put_ascii_items(WireBytes& out, const liberty::OutputList& list, const WireReading& reading);

}  // namespace sonoband::sim
