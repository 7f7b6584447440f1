// Layers of the band that a finger drags along its normal or makes thicker (core/reslice/rolling_band.h):
// when they are got ready, when a picture comes of them, when their memory goes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/reslice/rolling_band.h"

namespace sonoband {

class DragLayers {
 public:
  // More than `most_bytes` are never kept: of so large a band there are no layers.
  explicit DragLayers(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Layers of another sweep, or of other gaps between its frames, are given back.
  void follow(std::uint64_t sweep_version, const GapLimit& gap);

  // Of the sweep followed. The band out of its layers; empty where they are not ready or would cost more than
  // painting it whole, which takes `whole_ms` (0: not known). Not to be stopped: it takes less than that.
  std::optional<BandImage> render(PreparedSweep& sweep, const ReslicePlane& plane,
                                  const RenderSettings& settings, double whole_ms, Parallel& parallel);
  // Paints what the next step of a drag will need; ends soon after `stop` is set.
  void get_ready(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                 Parallel& parallel, const StopFlag& stop);

  std::size_t bytes() const { return band_.bytes(); }
  void give_back() { band_.clear(); }

 private:
  bool pays(const ReslicePlane& plane, const RenderSettings& settings) const;

  std::size_t most_bytes_;
  RollingBand band_;
  std::uint64_t sweep_version_ = 0;
  std::optional<double> gap_mm_;  // of the layers
  double ready_ms_ = 0;           // a layer that was got ready last; 0: not known
  double step_ms_ = 0;            // a layer that was missing in a step; 0: not known
};

// `to` is `from` moved along its normal.
bool moved_along_normal(const ReslicePlane& from, const ReslicePlane& to);

}  // namespace sonoband
