// Bytes as the protocol's description prints them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonoband::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes hex(std::string_view text) {
  Bytes bytes;
  int digits = 0;
  int value = 0;
  for (const char c : text) {
    const std::string_view all = "0123456789abcdef";
    const std::size_t digit = all.find(c);
    if (digit == std::string_view::npos) continue;
    value = value * 16 + static_cast<int>(digit);
    if (++digits == 2) {
      bytes.push_back(static_cast<std::uint8_t>(value));
      digits = value = 0;
    }
  }
  return bytes;
}

inline Bytes ascii(std::string_view text) {
  return {text.begin(), text.end()};
}

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The worked examples of the protocol's description, by its numbers.
namespace example {

// LIBERTY, station 1, 4 ms, frame 1, (25, -10.5, 3.25) cm, azimuth 10, elevation -20, roll 30 degrees.
inline const Bytes stream =
    hex("4c 59 01 43 00 00 28 00 04 00 00 00 01 00 00 00 00 00 00 00 00 00 c8 41 00 00 28 c1 00 00 50 40 "
        "44 97 71 3f 87 7d 89 3e ee 5a 14 be 66 be 02 3e");
// PATRIOT, 123456 ms, frame 29629, a quarter turn about Z.
inline const Bytes patriot =
    hex("50 41 01 43 00 00 28 00 40 e2 01 00 bd 73 00 00 00 00 00 00 00 00 c8 41 00 00 28 c1 00 00 50 40 "
        "f3 04 35 3f 00 00 00 00 00 00 00 00 f3 04 35 3f");
// List 2,7,8,9,11,12, no rotation.
inline const Bytes other_list =
    hex("4c 59 01 43 00 00 2c 00 00 00 c8 41 00 00 28 c1 00 00 50 40 00 00 80 3f 00 00 00 00 00 00 00 00 "
        "00 00 00 00 40 e2 01 00 bd 73 00 00 00 00 00 00 00 00 00 00");
// Poll with the default list 2,4,1: (1, 2, -3), (10, -20, 30) degrees.
inline const Bytes poll =
    hex("4c 59 01 50 00 00 1a 00 00 00 80 3f 00 00 00 40 00 00 40 c0 00 00 20 41 00 00 a0 c1 00 00 f0 41 "
        "0d 0a");
inline const Bytes error_reply = hex("4c 59 00 3f 01 00 11 00") + ascii("Invalid Command\r\n");
inline const Bytes stations = hex("4c 59 00 15 00 00 04 00 01 00 01 00");
inline const Bytes units = hex("4c 59 00 55 00 00 04 00 01 00 00 00");

}  // namespace example
}  // namespace sonoband::test
