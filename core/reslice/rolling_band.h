// A band that is dragged along its normal or made thicker and thinner: layers once painted are kept and only
// compounded anew, so that a step costs one layer instead of all.
#pragma once

#include <deque>
#include <vector>

#include "core/reslice/prepared_sweep.h"

namespace sonoband {

// Gives render_planar's picture, but for ties, while the plane moves by whole steps along its normal (a
// step's 1/1000 is allowed for rounding); any other change of plane, settings or sweep repaints. Memory: two
// bytes per pixel and layer.
class RollingBand {
 public:
  // Compounds on Doppler means are rendered whole: their sums are not kept.
  BandImage render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                   Parallel& parallel);

  // Layers painted since the last whole repaint, for statistics.
  int layers_painted() const { return layers_painted_; }
  // Forgets all layers, as after frames were appended.
  void clear();

 private:
  struct Layer {
    Pixels pixels;
    Pixels has_data;  // 255 or 0
  };
  struct Step {
    bool fits = false;
    int offset = 0;  // layers by which the new middle lies from layer_0_
  };
  Step step_to(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings) const;
  Layer paint(PreparedSweep& sweep, int index, Parallel& parallel);

  ReslicePlane plane_;  // of layer 0 of the index axis
  RenderSettings settings_;
  std::size_t frames_ = 0;
  std::deque<Layer> layers_;  // consecutive
  int first_ = 0;             // index of layers_.front(); layer i lies i steps along the normal of plane_
  int layers_painted_ = 0;
};

}  // namespace sonoband
