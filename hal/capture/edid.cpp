#include "hal/capture/edid.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

namespace sonoband {
namespace {

constexpr int largest_side = 4095;          // 12 bits
constexpr int largest_clock_10khz = 65535;  // 16 bits

// In pixels and lines: before the pulse, the pulse, all of the blanking.
struct Blanking {
  int front_x, sync_x, blank_x;
  int front_y, sync_y, blank_y;
};

struct Standard {
  int width, height, rate_hz;
  Blanking blanking;
};
// CEA-861.
constexpr Standard standards[] = {
    {1920, 1080, 60, {88, 44, 280, 4, 5, 45}},  {1920, 1080, 50, {528, 44, 720, 4, 5, 45}},
    {1920, 1080, 30, {88, 44, 280, 4, 5, 45}},  {1920, 1080, 25, {528, 44, 720, 4, 5, 45}},
    {1920, 1080, 24, {638, 44, 830, 4, 5, 45}}, {1280, 720, 60, {110, 40, 370, 5, 5, 30}},
    {1280, 720, 50, {440, 40, 700, 5, 5, 30}}};

Blanking blanking(int width, int height, double rate_hz) {
  for (const Standard& s : standards)
    if (s.width == width && s.height == height && s.rate_hz == std::lround(rate_hz)) return s.blanking;
  // VESA's reduced blanking: 160 pixels, and lines for at least 460 us.
  const double line_s = (1 / rate_hz - 460e-6) / height;
  return {48, 32, 160, 3, 5, std::max(14, static_cast<int>(std::ceil(460e-6 / line_s)))};
}

std::uint8_t low(int value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
// The bits of two values above the lowest `from`, `bits` of each, the first in the upper half.
std::uint8_t high_pair(int first, int second, int from, int bits) {
  const int mask = (1 << bits) - 1;
  return static_cast<std::uint8_t>(((first >> from) & mask) << bits | ((second >> from) & mask));
}

void put_timing(std::span<std::uint8_t> out, int width, int height, const Blanking& b, int clock_10khz) {
  constexpr std::uint8_t separate_positive_syncs = 0x1e;
  const std::uint8_t bytes[18] = {low(clock_10khz),
                                  low(clock_10khz >> 8),
                                  low(width),
                                  low(b.blank_x),
                                  high_pair(width, b.blank_x, 8, 4),
                                  low(height),
                                  low(b.blank_y),
                                  high_pair(height, b.blank_y, 8, 4),
                                  low(b.front_x),
                                  low(b.sync_x),
                                  high_pair(b.front_y, b.sync_y, 0, 4),
                                  static_cast<std::uint8_t>(high_pair(b.front_x, b.sync_x, 8, 2) << 4 |
                                                            high_pair(b.front_y, b.sync_y, 4, 2)),
                                  0,
                                  0,
                                  0,
                                  0,
                                  0,  // a size in mm nobody can see
                                  separate_positive_syncs};
  std::copy(std::begin(bytes), std::end(bytes), out.begin());
}

void put_text(std::span<std::uint8_t> out, std::uint8_t tag, std::string_view text) {
  out[3] = tag;
  std::fill(out.begin() + 5, out.begin() + 18, std::uint8_t{' '});
  std::copy(text.begin(), text.end(), out.begin() + 5);
  if (text.size() < 13) out[5 + text.size()] = '\n';
}

}  // namespace

std::array<std::uint8_t, 128> edid(int width, int height, double rate_hz) {
  std::array<std::uint8_t, 128> out{};
  if (width < 16 || height < 16 || width > largest_side || height > largest_side || !(rate_hz >= 1) ||
      !(rate_hz <= 240))
    return out;
  const Blanking b = blanking(width, height, rate_hz);
  const double clock = rate_hz * (width + b.blank_x) * (height + b.blank_y) / 10'000;
  if (clock > largest_clock_10khz) return out;

  const std::uint8_t head[] = {
      0,    0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0,    0x4d, 0xee,  // maker "SON"
      1,    0,    0,    0,    0,    0,    0,    34,                // product 1, made in 2024
      1,    4,                                                     // EDID 1.4
      0x80, 0,    0,    120,  0x0e,  // digital; gamma 2.2; RGB, sRGB, the first timing is preferred
      0xee, 0x91, 0xa3, 0x54, 0x4c, 0x99, 0x26, 0x0f, 0x50, 0x54,  // sRGB's colours
      0x20, 0,    0};                                              // 640 x 480 at 60 Hz, as every display
  std::copy(std::begin(head), std::end(head), out.begin());
  std::fill(out.begin() + 38, out.begin() + 54, std::uint8_t{1});  // no standard timings
  const std::span<std::uint8_t> all(out);
  put_timing(all.subspan(54, 18), width, height, b, static_cast<int>(std::lround(clock)));
  put_text(all.subspan(72, 18), 0xfc, "Sonoband");
  constexpr std::uint8_t nothing = 0x10;
  out[90 + 3] = nothing;
  out[108 + 3] = nothing;
  int sum = 0;
  for (const std::uint8_t byte : out) sum += byte;
  out[127] = low(256 - sum % 256);
  return out;
}

}  // namespace sonoband
