// One byte for grey and colour: an ordered key, so that the paper's maximum and minimum rules for Doppler are
// plain byte comparisons. Source: the paper, "Planar volume rendering"; Stradx byte code (grey 0..127, blue
// 128..191, red 192..255).
//
// key = grey for 0..127 (grey is 7 bits in a Doppler picture); key = 128 + 2 * level + (red ? 1 : 0), level 0
// (dark) to 63 (bright). So any colour beats any grey, a brighter colour a darker one, and red beats blue of
// the same level.
//
// Keys are never averaged or interpolated as numbers.
//   mean: if at least one sample is coloured, the mean of the velocities of all samples (grey counts as 0),
//     rounded half away from zero; a mean of 0 gives the mean of the grey samples (0 if there is none).
//     Without colour the mean of the greys. Grey means are rounded halves up.
//   linear: of the up to 8 taps with their weights (sum 1), if the coloured ones weigh at least 1/2 the
//   sample
//     has their weighted mean velocity, rounded half away from zero, 0 being the darkest red; else it is the
//     weighted mean of the grey ones, rounded halves up.
#pragma once

#include <cstdint>

namespace sonoband::doppler {

constexpr int level_count = 64;

constexpr bool is_colour(std::uint8_t key) {
  return key >= 128;
}
constexpr std::uint8_t grey_key(int grey7) {
  return static_cast<std::uint8_t>(grey7);
}
constexpr std::uint8_t colour_key(int level, bool red) {
  return static_cast<std::uint8_t>(128 + 2 * level + (red ? 1 : 0));
}

// Signed velocity in levels: grey and the darkest colours 0, red positive, blue negative.
constexpr int velocity(std::uint8_t key) {
  if (!is_colour(key)) return 0;
  const int level = (key - 128) / 2;
  return (key & 1) != 0 ? level : -level;
}

// A signed velocity in levels, -63 to 63, back to a key; 0 is the darkest red.
constexpr std::uint8_t velocity_key(int v) {
  return colour_key(v < 0 ? -v : v, v >= 0);
}

}  // namespace sonoband::doppler
