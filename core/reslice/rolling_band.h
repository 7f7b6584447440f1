// A band that is dragged along its normal or made thicker and thinner: layers once painted are kept, so that
// a step costs the layers that are new and a few passes over the picture.
//
// Maxima (or minima) are kept of every run of 2, 4, 8 ... layers that begins at a multiple of its length, as
// far as they were needed; any band is at most 2 log2 N such runs. How many layers have data, and the sums of
// a mean, are whole numbers: a layer that comes is added, one that goes is taken off.
#pragma once

#include <map>
#include <vector>

#include "core/reslice/prepared_sweep.h"

namespace sonoband {

// While the plane moves by whole steps along its normal (a step's 1/1000 is allowed for rounding) or the
// thickness changes, the picture is, to the last bit, that of its layers each painted by render_planar as a
// thin plane, however the band got there; so it is render_planar's of the band but for ties. The first
// picture of a plane, and one whose compounding alone differs, is render_planar's itself: layers are painted
// when the band first moves (a drag's first step costs all of them, some ten times a later one).
//
// Memory: up to 4 bytes per pixel and layer kept, of at most 1.5 N + 16 layers, and 6 per pixel: 14 mm of
// 640x480 hold 130 MB at most, 60 MB at first.
class RollingBand {
 public:
  // Means of Doppler pictures are rendered whole: their sums are not kept.
  BandImage render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                   Parallel& parallel);

  // Layers painted since the last whole picture, for statistics.
  int layers_painted() const { return layers_painted_; }
  // Of all pictures and sums kept.
  std::size_t bytes() const;
  // Forgets all layers, as after frames were appended.
  void clear();

 private:
  struct Layer {
    Pixels pixels;
    Pixels has_data;                      // 255 or 0
    ImageBuffer<std::uint16_t> coverage;  // until has_data is made of it
  };
  // Of layers first .. first + 2^level - 1.
  struct Run {
    int level = 0, first = 0;
    auto operator<=>(const Run&) const = default;
  };
  struct Window {
    int first = 0, last = -1;
    bool empty() const { return last < first; }
    bool holds(int layer) const { return layer >= first && layer <= last; }
  };

  bool follows(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
               int& offset) const;
  void begin(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings);
  void paint_missing(PreparedSweep& sweep, const Window& band, Parallel& parallel);
  void forget_far(const Window& band);
  std::vector<Run> runs_of(const Window& band) const;
  void need(const Run& run, std::vector<Run>& to_build);
  const Pixels& pixels_of(const Run& run) const;
  BandImage compound(const Window& band, Parallel& parallel);

  ReslicePlane plane_;  // of layer 0; layer i lies i steps along its normal
  RenderSettings settings_;
  std::size_t frames_ = 0;
  bool begun_ = false;
  int offset_ = 0;  // of the last picture's middle layer
  std::map<int, Layer> layers_;
  std::uint8_t missing_ = 0;    // in pixels without data: what never is the extreme
  std::map<Run, Pixels> runs_;  // level 1 and above
  Window counted_;              // whose layers are in counts_ and sums_
  bool summed_ = false;
  ImageBuffer<std::uint16_t> counts_;
  ImageBuffer<std::uint32_t> sums_;
  int layers_painted_ = 0;
  int left_out_ = 0;  // frames, by RenderSettings::thin_dense_frames
};

}  // namespace sonoband
