#include "tests/core/reslice/stacked_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/reslice/rolling_band.h"

namespace sonoband::test {

BandImage thin_layer(PreparedSweep& sweep, ReslicePlane plane, RenderSettings settings, int i) {
  Serial serial;
  RollingBand rolling;
  settings.band.thickness_mm = 2 * (std::abs(i) + 1) * settings.band.step_mm;
  settings.compounding = Compounding::maximum;
  rolling.render(sweep, plane, settings, serial);
  plane.origin = plane.origin + (i * settings.band.step_mm) * plane.normal();
  rolling.render(sweep, plane, settings, serial);
  settings.band.thickness_mm = 0;
  BandImage image = rolling.render(sweep, plane, settings, serial);
  EXPECT_GT(rolling.layers_painted(), i == 0 ? -1 : 0);
  return image;
}

BandImage stacked(PreparedSweep& sweep, const ReslicePlane& anchor, const RenderSettings& settings,
                  int middle) {
  const int side = (settings.band.layers() - 1) / 2;
  BandImage out{Pixels(anchor.width, anchor.height), ImageBuffer<std::uint16_t>(anchor.width, anchor.height),
                PixelKind::grey};
  ImageBuffer<std::uint32_t> sums(anchor.width, anchor.height);
  for (int i = middle - side; i <= middle + side; ++i) {
    const BandImage layer = thin_layer(sweep, anchor, settings, i);
    for (int y = 0; y < anchor.height; ++y) {
      for (int x = 0; x < anchor.width; ++x) {
        if (layer.coverage.view()(x, y) == 0) continue;
        const std::uint8_t v = layer.pixels.view()(x, y);
        std::uint8_t& best = out.pixels.view()(x, y);
        const bool first = out.coverage.view()(x, y)++ == 0;
        sums.view()(x, y) += v;
        best = first                                          ? v
               : settings.compounding == Compounding::minimum ? std::min(best, v)
                                                              : std::max(best, v);
      }
    }
  }
  if (settings.compounding != Compounding::mean) return out;
  for (int y = 0; y < anchor.height; ++y) {
    for (int x = 0; x < anchor.width; ++x) {
      const std::uint32_t n = out.coverage.view()(x, y);
      if (n > 0) out.pixels.view()(x, y) = static_cast<std::uint8_t>((2 * sums.view()(x, y) + n) / (2 * n));
    }
  }
  return out;
}

}  // namespace sonoband::test
