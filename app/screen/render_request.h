// What the screen asks of the render worker, and what it gets: values.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/plane.h"
#include "core/manifold/manifold_band.h"
#include "core/reslice/prepared_sweep.h"

namespace sonoband {

// Frames, and what keeps them alive.
struct HeldSweep {
  SweepView view;
  std::shared_ptr<const void> keeper;
};

// Its mask without what the scanner draws over Doppler pictures (core/sweep/drawings.h).
HeldSweep without_drawings(HeldSweep held);

struct RenderRequest {
  HeldSweep sweep;
  std::uint64_t sweep_id = 0;       // comes back with the result
  std::uint64_t sweep_version = 0;  // changes with the frames
  ReslicePlane plane;
  RenderSettings settings;
  // On a plane of its own, which in-plane moves of the other leave where it is. Fewer than two points: no
  // manifold is asked for.
  std::vector<Eigen::Vector2d> curve_mm;
  ReslicePlane curve_plane;
  double reach_mm = 0;  // the paper's r
  // By a finger: another request follows, the last one without it. Frames denser than pixels are left out.
  bool moving = false;
  double budget_ms = 0;  // while moving: from when on a coarse picture is better than none; 0: never
  // The plane will move along its normal next, or its thickness change.
  bool drag_ahead = false;
};

// Whatever matters to both pictures is the same: frames and how the band is made of them.
bool same_look(const RenderRequest& a, const RenderRequest& b);
bool same_plane(const ReslicePlane& a, const ReslicePlane& b);
// The manifold is the same picture.
bool same_surface(const RenderRequest& a, const RenderRequest& b);
bool has_surface(const RenderRequest& request);
// After `to` comes a step along the normal, or of the thickness.
bool drags(const RenderRequest& from, const RenderRequest& to);
// Pixels of the planar band times its layers.
double samples_of(const RenderRequest& request);

struct Stretch {
  double from_mm = 0;  // arc length along the curve
  double to_mm = 0;
};

struct PlanarPicture {
  BandImage band;
  ReslicePlane plane;  // of its pixels
  int layers = 0;
  double ms = 0;
  double thread_ms = 0;  // processor time of the worker's own thread, which does its share of the work
  double first_ms = 0;   // of that, until the coarse picture before this one; else all
  bool coarse = false;
  bool from_layers = false;   // of a drag
  bool exact = true;          // render_planar's bits of what was asked, no frame left out
  std::uint64_t version = 0;  // ascending
};

// The unrolled surface as the screen shows it: columns follow the curve, rows its normal n.
struct ManifoldPicture {
  BandImage band;
  double pixel_mm = 0;
  double length_mm = 0;
  int layers = 0;
  double thickness_mm = 0;
  std::vector<PlaneLine> up, down;  // the paper's c_u and c_d, plane mm
  std::vector<Stretch> smeared;     // where some layer shows one ruling in several columns
  double ms = 0;
  bool coarse = false;
  bool exact = true;
  std::uint64_t version = 0;
};

// Of two results the pictures whose request did not change are the same ones.
struct RenderResult {
  std::shared_ptr<const PlanarPicture> planar;
  std::shared_ptr<const ManifoldPicture> manifold;  // null: none was asked for, or the curve makes none
  std::uint64_t sweep_id = 0;
  std::uint64_t sweep_version = 0;
  std::uint64_t version = 0;
  double waited_ms = 0;  // by the clock, from the request to the begin of its work
};

}  // namespace sonoband
