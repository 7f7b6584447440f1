#include "hal/sim/liberty_wire.h"

#include <algorithm>
#include <cstdio>

#include "hal/tracker/little_endian.h"

namespace sonoband::sim {

using liberty::Item;

void WireBytes::byte(std::uint8_t b) {
  if (size < capacity) data[size++] = b;
}

void WireBytes::u16(std::uint16_t v) {
  byte(static_cast<std::uint8_t>(v));
  byte(static_cast<std::uint8_t>(v >> 8));
}

void WireBytes::u32(std::uint32_t v) {
  u16(static_cast<std::uint16_t>(v));
  u16(static_cast<std::uint16_t>(v >> 16));
}

void WireBytes::f32(float v) {
  u32(std::bit_cast<std::uint32_t>(v));
}

void WireBytes::text(const char* s) {
  for (; *s != 0; ++s) byte(static_cast<std::uint8_t>(*s));
}

void WireBytes::format(const char* pattern, double v) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), pattern, v);
  text(buffer.data());
}

void begin_frame(WireBytes& out, liberty::Tag tag, int station, std::uint8_t command, std::uint8_t error) {
  out.size = 0;
  out.u16(static_cast<std::uint16_t>(tag));
  out.byte(static_cast<std::uint8_t>(station));
  out.byte(command);
  out.byte(error);
  out.byte(0);
  out.u16(0);
}

void finish_frame(WireBytes& out) {
  wire::store_u16(out.data.data() + 6, static_cast<std::uint16_t>(out.size - liberty::header_bytes));
}

void put_binary_items(WireBytes& out, const liberty::OutputList& list, const WireReading& r) {
  for (const std::uint8_t code : list.items()) {
    switch (static_cast<Item>(code)) {
      case Item::space:
        out.byte(' ');
        break;
      case Item::crlf:
        out.text("\r\n");
        break;
      case Item::position:
      case Item::position_extended:
        for (const float v : r.position) out.f32(v);
        break;
      case Item::angles:
      case Item::angles_extended:
        for (const float v : r.angles_deg) out.f32(v);
        break;
      case Item::quaternion:
        for (const float v : r.quaternion) out.f32(v);
        break;
      case Item::time_ms:
        out.u32(r.time_ms);
        break;
      case Item::frame_count:
        out.u32(r.frame);
        break;
      case Item::distortion:
        out.u32(static_cast<std::uint32_t>(r.distortion));
        break;
      case Item::stylus:
      case Item::sync:
        out.u32(0);
        break;
    }
  }
}

void put_ascii_items(WireBytes& out, const liberty::OutputList& list, const WireReading& r) {
  for (const std::uint8_t code : list.items()) {
    switch (static_cast<Item>(code)) {
      case Item::space:
        out.byte(' ');
        break;
      case Item::crlf:
        out.text("\r\n");
        break;
      case Item::position:
        for (const float v : r.position) out.format("%9.3f", static_cast<double>(v));
        break;
      case Item::position_extended:
        for (const float v : r.position) out.format(" %.6E", static_cast<double>(v));
        break;
      case Item::angles:
        for (const float v : r.angles_deg) out.format("%9.3f", static_cast<double>(v));
        break;
      case Item::angles_extended:
        for (const float v : r.angles_deg) out.format(" %.6E", static_cast<double>(v));
        break;
      case Item::quaternion:
        for (const float v : r.quaternion) out.format("%9.5f", static_cast<double>(v));
        break;
      case Item::time_ms:
        out.format(" %.0f", r.time_ms);
        break;
      case Item::frame_count:
        out.format(" %.0f", r.frame);
        break;
      case Item::distortion:
        out.format(" %.0f", r.distortion);
        break;
      case Item::stylus:
      case Item::sync:
        out.text(" 0");
        break;
    }
  }
}

}  // namespace sonoband::sim
