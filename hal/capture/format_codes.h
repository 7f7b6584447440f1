// What a system of video calls the formats, as a table that is looked up both ways.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/devices.h"

namespace sonoband {

struct FormatCode {
  PixelFormat format;
  std::uint32_t fourcc;
};

// Pixels. A device that agrees to more lies, and its sizes would overflow.
inline constexpr unsigned largest_side_px = 16384;

// Of a format that the table has not: 0, which is no code.
inline std::uint32_t code_of(PixelFormat format, std::span<const FormatCode> table) {
  for (const FormatCode& c : table)
    if (c.format == format) return c.fourcc;
  return 0;
}

// Adds what the code stands for, if it is one of ours.
inline void offer(std::uint32_t fourcc, std::span<const FormatCode> table,
                  std::vector<PixelFormat>& offered) {
  for (const FormatCode& c : table)
    if (c.fourcc == fourcc) offered.push_back(c.format);
}

}  // namespace sonoband
