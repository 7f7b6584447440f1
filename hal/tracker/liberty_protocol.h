// The binary frames of the Polhemus LIBERTY, PATRIOT and LATUS: eight bytes of header, then a body. There is
// no checksum and no trailer; the tag, the station, the error byte and the exact size are all there is to
// check.
//
// | offset | size | field                                                            |
// |--------|------|------------------------------------------------------------------|
// | 0      | 2    | tag: "LY", "PA" or "LU"                                          |
// | 2      | 1    | station, 1-based; 0 where none is meant                          |
// | 3      | 1    | the command that caused it: 'C' for the stream, 0x15 for ^U, ... |
// | 4      | 1    | error                                                            |
// | 5      | 1    | reserved                                                         |
// | 6      | 2    | size of the body, little-endian                                  |
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "core/time.h"

namespace sonoband::liberty {

// As load_u16 reads the two letters.
enum class Tag : std::uint16_t { liberty = 0x594c, patriot = 0x4150, latus = 0x554c };

constexpr std::size_t header_bytes = 8;
constexpr std::size_t max_body_bytes = 992;  // a record is at most 1000 bytes
constexpr int max_stations = 16;
constexpr std::uint8_t stream_command = 'C';

constexpr int stations_of(Tag tag) {
  return tag == Tag::patriot ? 2 : max_stations;
}

// What a record can hold. Code 6 (direction cosines) is left out: public sources disagree about its size.
enum class Item : std::uint8_t {
  space = 0,
  crlf = 1,
  position = 2,           // x y z, 3 x f32, cm or inch as the unit command says
  position_extended = 3,  // the same in binary
  angles = 4,             // azimuth, elevation, roll, 3 x f32 degrees
  angles_extended = 5,
  quaternion = 7,   // scalar first, 4 x f32
  time_ms = 8,      // u32
  frame_count = 9,  // u32
  stylus = 10,      // i32
  distortion = 11,  // i32: 0 none, 1 some, 2 high
  sync = 12,        // i32: an external pulse arrived in this frame
};

// Bytes of an item in a binary record; 0 for an unknown code.
constexpr std::size_t binary_size(std::uint8_t code) {
  constexpr std::array<std::uint8_t, 13> sizes{1, 2, 12, 12, 12, 12, 0, 16, 4, 4, 4, 4, 4};
  return code < sizes.size() ? sizes[code] : 0;
}

// The items of a record, in order, packed.
struct OutputList {
  static constexpr int capacity = 20;
  std::array<std::uint8_t, capacity> codes{};
  int count = 0;

  constexpr OutputList() = default;
  constexpr OutputList(std::initializer_list<Item> items) {
    for (const Item i : items)
      if (count < capacity) codes[static_cast<std::size_t>(count++)] = static_cast<std::uint8_t>(i);
  }
  std::span<const std::uint8_t> items() const { return {codes.data(), static_cast<std::size_t>(count)}; }
  constexpr std::size_t body_bytes() const {
    std::size_t n = 0;
    for (int i = 0; i < count; ++i) n += binary_size(codes[static_cast<std::size_t>(i)]);
    return n;
  }
  friend constexpr bool operator==(const OutputList&, const OutputList&) = default;
};

// What the link asks for: time and counter first, so that a damaged tail still says which record it was.
// 40 bytes; 48 with the header.
constexpr OutputList tracking_list{Item::time_ms, Item::frame_count, Item::distortion,
                                   Item::position_extended, Item::quaternion};

// One frame from the tracker.
struct Packet {
  Tag tag{};
  std::uint8_t station = 0;
  std::uint8_t command = 0;
  std::uint8_t error = 0;
  std::span<const std::uint8_t> body;  // lives in the parser until its next push
  Stamp arrived{};                     // when the read that completed it returned
};

// What an error byte means to us.
enum class ErrorKind : std::uint8_t {
  none,
  notice,         // worth a line in the log
  configuration,  // a command of ours was wrong
  hardware,       // a processor or memory of the unit failed
  source_fault,   // the transmitter failed: its poses are worthless
  self_test,      // usable, but the unit's self-test found something
  outside_map,    // outside the volume of the metal compensation map
  unknown,
};

ErrorKind classify(std::uint8_t error);

// The vendor's meaning in a few words; static storage.
const char* error_text(std::uint8_t error);

}  // namespace sonoband::liberty
