// Layers of a band kept apart for later bands.
#pragma once

#include <cassert>
#include <cstdint>

#include "core/image/image.h"

namespace sonoband {

// Row y of all layers lies together: pictures of their own would begin at multiples of a cache's pages, and
// what is painted at the same place of several layers would evict itself.
struct LayerBlock {
  static constexpr int most_layers = 16;

  LayerBlock(int columns, int rows, int layer_count)
      : width(columns),
        layers(layer_count),
        values(Pixels::unset(columns * layer_count, rows)),
        has_data(ImageBuffer<std::uint16_t>::unset(columns, rows)) {
    assert(layer_count <= most_layers);
  }

  std::uint8_t* values_row(int layer, int y) { return values.view().row(y) + layer * width; }
  const std::uint8_t* values_row(int layer, int y) const { return values.view().row(y) + layer * width; }

  // The bits of has_data of so many layers from `first` on.
  static std::uint16_t bits(int first, int count) {
    return static_cast<std::uint16_t>(((1U << count) - 1) << first);
  }

  int width = 0, layers = 0;
  Pixels values;                        // where there is no data: 0, or 255 where minima are asked for
  ImageBuffer<std::uint16_t> has_data;  // of a pixel; bit l: of layer l
};

}  // namespace sonoband
