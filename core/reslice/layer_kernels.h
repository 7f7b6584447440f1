// Vector code over rows of painted layers, one set for each instruction set, chosen at run time by Highway.
#pragma once

#include <cstdint>

namespace sonoband {

// A row of one layer: 255 where it has data, else 0; `values` there mean nothing.
struct LayerRow {
  const std::uint8_t* values = nullptr;
  const std::uint8_t* has_data = nullptr;
};

struct LayerKernels {
  // out[x] = the greatest, or least, of rows[0][x] .. rows[count - 1][x]; count > 0. `out` may be one of
  // them.
  void (*fold)(const std::uint8_t* const* rows, int count, bool minimum, int width, std::uint8_t* out);

  // Adds a layer to, or takes it from, how many have data and, if `sums` is given, the sum of their values.
  void (*count)(const LayerRow& layer, bool add, int width, std::uint16_t* counts, std::uint32_t* sums);

  // Zero where counts[x] is 0.
  void (*blank)(const std::uint16_t* counts, int width, std::uint8_t* values);

  // sums / counts, halves up; 0 where counts[x] is 0. Exact for sums below 2^24.
  void (*mean)(const std::uint32_t* sums, const std::uint16_t* counts, int width, std::uint8_t* out);
};

const LayerKernels& layer_kernels();

}  // namespace sonoband
