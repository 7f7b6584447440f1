// Layers of a band kept apart for later bands.
#pragma once

#include "core/image/image.h"

namespace sonoband {

// Row y of all layers lies together: pictures of their own would begin at multiples of a cache's pages, and
// what is painted at the same place of several layers would evict itself.
struct LayerBlock {
  LayerBlock(int columns, int rows, int layers)
      : width(columns), values(columns * layers, rows), has_data(columns * layers, rows) {}

  std::uint8_t* values_row(int layer, int y) { return values.view().row(y) + layer * width; }
  std::uint8_t* has_data_row(int layer, int y) { return has_data.view().row(y) + layer * width; }
  const std::uint8_t* values_row(int layer, int y) const { return values.view().row(y) + layer * width; }
  const std::uint8_t* has_data_row(int layer, int y) const { return has_data.view().row(y) + layer * width; }

  int width = 0;
  Pixels values;    // where there is no data: 0, or 255 where minima are asked for
  Pixels has_data;  // 255 or 0
};

}  // namespace sonoband
