// Little-endian fields of a wire format, whatever the host's order and alignment.
#pragma once

#include <bit>
#include <cstdint>

namespace sonoband::wire {

inline std::uint16_t load_u16(const std::uint8_t* p) {
  return static_cast<std::uint16_t>(p[0] | p[1] << 8);
}
inline std::uint32_t load_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(load_u16(p)) | static_cast<std::uint32_t>(load_u16(p + 2)) << 16;
}
inline std::int32_t load_i32(const std::uint8_t* p) {
  return static_cast<std::int32_t>(load_u32(p));
}
inline float load_f32(const std::uint8_t* p) {
  return std::bit_cast<float>(load_u32(p));
}

inline void store_u16(std::uint8_t* p, std::uint16_t v) {
  p[0] = static_cast<std::uint8_t>(v);
  p[1] = static_cast<std::uint8_t>(v >> 8);
}
inline void store_u32(std::uint8_t* p, std::uint32_t v) {
  store_u16(p, static_cast<std::uint16_t>(v));
  store_u16(p + 2, static_cast<std::uint16_t>(v >> 16));
}
inline void store_f32(std::uint8_t* p, float v) {
  store_u32(p, std::bit_cast<std::uint32_t>(v));
}

}  // namespace sonoband::wire
