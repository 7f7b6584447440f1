// Narrow-band volume rendering straight from B-scans: what is asked for and what comes back.
// Source: the paper, "Planar volume rendering"; Gee et al., BJR 2004;77:S186 for the nearest-B-scan rule.
//
// The definition, which tests/core/reslice/reference.h carries out slowly in double precision and every
// kernel obeys:
//
// A sample point P of World has, on frame i, the foot (x, y) in pixels and the signed distance z in mm, from
// image_from_world. The frame's picture contains the foot when pixel (floor(x + 1/2), floor(y + 1/2)) is in
// the picture and in the mask.
//   nearest: of the frames that contain the foot with |z| <= d_i the one with the smallest |z| gives that
//   pixel; of equal |z| the later frame (greater captured, then sweep_id, then sequence). None: no data,
//   which is never black. linear: let A be that frame. B is, of the frames that contain their foot on the
//   other side of P with |z| <= 2 d_i, the one with the smallest |z| (same tie rule). Sides are told by the
//   sign of z along the frame's normal (0 counts as positive); the normals of a whole sweep are flipped where
//   its mean normal opposes that of the sweep with the earliest frame. Each gives its bilinear value at the
//   foot (taps outside picture or mask take no part, the weights of the others are renormalised); the value
//   is (a |zB| + b |zA|) / (|zA| + |zB|), rounded once, halves up. Without B: a.
// Twice d for B because automatic d is half a gap, and a sample near A must still see across the whole gap.
// Positions and distances within core/reslice/ties.h of a boundary are on it: x + 1/2 so close below an
// integer is that integer, |z| so close above d is d, and |z| so close to the smallest is equal to it.
// Doppler keys are never interpolated as numbers: core/image/doppler.h.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/plane.h"
#include "core/parallel.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband {

enum class Compounding : std::uint8_t { maximum, minimum, mean };
enum class Interpolation : std::uint8_t { nearest, linear };

// d of the definition: how far from a B-scan its pixels may be used, in mm.
struct GapLimit {
  // Empty: automatic per frame, half of the largest distance of its four corners from the planes of its
  // neighbours in the sweep, so that no gap between neighbours is left open; see gap_limits for jumps and
  // ends.
  std::optional<double> mm;
};

// A slab of layers one step apart, centred on the surface.
struct Band {
  double thickness_mm = 0;  // usually 0 (thin) to 20
  double step_mm = 0.2;     // the width of one B-scan pixel (paper, section 2)

  int layers() const;  // N = 2 round(T / 2 step) + 1, halves up: odd, the middle layer is the surface
  double offset_mm(int layer) const;  // of a layer along the normal: (layer - (N-1)/2) step
};

struct RenderSettings {
  Band band;
  Compounding compounding = Compounding::maximum;
  Interpolation interpolation = Interpolation::nearest;
  GapLimit gap;
  // Leaves out frames that lie denser than the output can show; off for bit-exact work. A sample then takes
  // the definition's value at a point at most half a pixel away along each of the picture's axes: planes by
  // the rule of core/reslice/chain.h, by what each part of the picture sees of the frames (so linear does not
  // blend frames a pixel or less apart, but takes the nearer); parts where they cross, or with linear end,
  // curved surfaces and rolling bands by those of core/reslice/thinning.h.
  bool thin_dense_frames = false;
};

// A result. coverage(x, y) counts the layers that had data there; where it is 0 the pixel is 0 and means
// nothing. Mean is rounded once, halves up. Grey or Doppler as the sweep is.
struct BandImage {
  Pixels pixels;
  ImageBuffer<std::uint16_t> coverage;
  PixelKind kind = PixelKind::grey;
  // By RenderSettings::thin_dense_frames; on planes in the mean over the picture's tiles.
  int frames_left_out = 0;
  // Parts of pictures were turned for it: with pictures that are kept turned (turned_frames.h) it takes less.
  bool turned_parts = false;
};

// Parallel, equally sampled lines: what both a plane and an unrolled surface are. Row r of the picture is
// compounded from lines (r, 0) .. (r, layers-1); sample s of line (r, l) is at starts[r * layers + l] + s *
// step.
struct LineBundle {
  int samples = 0;  // per line; the picture's width
  int rows = 0;     // the picture's height
  int layers = 1;
  Direction<frame::World> step;  // mm from one sample to the next, common to all lines
  std::vector<Point<frame::World>> starts;
  std::vector<std::uint8_t>
      present;  // 0: this line does not exist (the front has vanished); empty: all exist
};

// The lines of a plane's band: what render_planar paints.
LineBundle plane_lines(const ReslicePlane& plane, const Band& band);

// Thread-safe for the caller: reads the sweep, writes only the result. Same bits for any Parallel.
BandImage render_planar(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                        Parallel& parallel);

// settings.band counts only through bundle.layers. A bundle that is a plane's gives render_planar's bits.
BandImage render_lines(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings,
                       Parallel& parallel);

// d per frame of sweep.frames, in mm. Automatic d_i is half the largest |n_i . (corner_j - corner_i)| over
// the four corners and the previous and next frame j of the same sweep (in order of capture, whatever the
// order of the span). A neighbour farther than 4 x the median of the sweep's largest corner distances is a
// jump and does not count; a frame left with no neighbour takes half the median. The median is over distances
// of at least half a pixel's width: a probe held still for most of a sweep must not make every move a jump.
// d is never below half a pixel's width, so that a probe held still paints.
std::vector<double> gap_limits(const SweepView& sweep, const GapLimit& gap);

// Those of sweep.frames that stay when none need be closer than `pixel_mm`: going through each sweep in order
// of capture, a frame is left out while the next is still within a pixel (thinning_pixel, thinning.h) of the
// last that stayed, at every corner. So a frame left out of a steady sweep lies between two that stay and are
// at most a pixel apart, and a sample's position moves by at most half a pixel across the frames. The first
// and last of a sweep stay.
std::vector<const TrackedFrame*> thinned(const SweepView& sweep, double pixel_mm);

// Width of one pixel in mm of the sweep's first frame: the paper's resolution cell. 0 without frames.
double pixel_width_mm(const SweepView& sweep);

}  // namespace sonoband
