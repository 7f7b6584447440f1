// c(s): the curve on a reslice plane along which a curved surface stands. Source: the paper, "Non-planar
// volume rendering" (a stroke of the finger or mouse on the Reslice window).
//
// A raw stroke is resampled to a pixel and smoothed along its arc length before anything is made of it: with
// the jitter of a hand the propagation of the paper picks 25 to 31 % wrong rulings, after a Gaussian of 4 px
// none. What comes out is what the user is shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/manifold/plane_point.h"

namespace sonoband {

// A polyline without repeated neighbours: two or more vertices, three or more when closed. It may cross
// itself and may turn back on itself; the flow has rules for both.
struct Curve {
  std::vector<PlanePoint> vertices;  // plane mm
  bool closed = false;               // an edge joins the last vertex to the first, which is not repeated

  int edges() const {
    const int count = static_cast<int>(vertices.size());
    return closed || count == 0 ? count : count - 1;
  }
  const PlanePoint& edge_start(int edge) const { return vertices[edge]; }
  const PlanePoint& edge_end(int edge) const { return vertices[(edge + 1) % vertices.size()]; }
};

double length_mm(const Curve& curve);

// Why a stroke makes no curve.
enum class CurveFault : std::uint8_t {
  none,
  bad_settings,    // pixel not positive, smoothing negative or above max_smooth_px, or either not finite
  no_points,       //
  not_finite,      // `point` says which
  one_point,       // all points coincide
  closed_too_few,  // closed, with fewer than three different points
  too_long,        // more than max_curve_px pixels or points
};

// Half a minute of drawing at full speed is 10,000 px; the limits keep a broken file from taking all memory.
constexpr int max_curve_px = 65536;
constexpr double max_smooth_px = 1000;

// What is wrong and the cure, to follow "the curve": "has no points; draw it again".
std::string_view describe(CurveFault fault);

struct CurveSettings {
  double pixel_mm = 0.2;  // of the plane
  double smooth_px = 4;   // sigma of the Gaussian; 0 leaves the points as given, repeated ones dropped
  bool closed = false;
};

struct CurveResult {
  Curve curve;  // valid when fault is none
  CurveFault fault = CurveFault::none;
  std::size_t point = 0;        // of the stroke, where the fault is one point's
  bool crosses_itself = false;  // legal, but anatomy near the crossing belongs to both passes: tell the user
};

// Ends stay where they were drawn; a closed stroke is smoothed round its seam. A curve that is straight to
// within 1e-9 of its length comes out as its two ends, whatever vertices it was given by.
CurveResult make_curve(std::span<const PlanePoint> stroke, const CurveSettings& settings);

bool crosses_itself(const Curve& curve);

// One line of the curved surface and one row of its picture stands here, parallel to the plane's normal.
struct RulingFoot {
  PlanePoint at;        // plane mm
  int edge = 0;         // of the curve
  double along_mm = 0;  // from the start of that edge
};

// round(L / spacing) + 1 feet at equal arc length, from the first vertex to the last (of a closed curve: back
// to the first). So they are `spacing` apart to within half a spacing over the whole curve, and exactly when
// L is a multiple of it.
std::vector<RulingFoot> ruling_feet(const Curve& curve, double spacing_mm);

}  // namespace sonoband
