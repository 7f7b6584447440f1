// Vector code over rows of painted layers, one set for each instruction set, chosen at run time by Highway.
#pragma once

#include <cstdint>

namespace sonoband {

struct LayerKernels {
  // out[x] = the greatest, or least, of rows[0][x] .. rows[count - 1][x]; count > 0. `out` may be one of
  // them.
  void (*fold)(const std::uint8_t* const* rows, int count, bool minimum, int width, std::uint8_t* out);

  // Adds to, or takes from, how many layers have data: those of a block's row whose bits are in `layers`.
  void (*count)(const std::uint16_t* has_data, std::uint16_t layers, bool add, int width,
                std::uint16_t* counts);

  // Adds a layer's row to, or takes it from, sums; values without data are 0.
  void (*sum)(const std::uint8_t* values, bool add, int width, std::uint32_t* sums);

  // Zero where counts[x] is 0.
  void (*blank)(const std::uint16_t* counts, int width, std::uint8_t* values);

  // sums / counts, halves up; 0 where counts[x] is 0. Exact for sums below 2^24.
  void (*mean)(const std::uint32_t* sums, const std::uint16_t* counts, int width, std::uint8_t* out);
};

const LayerKernels& layer_kernels();

}  // namespace sonoband
