// How the Outline window looks at the sweep: a camera on a sphere round the middle of it.
#pragma once

#include <Eigen/Core>

namespace sonoband::ui {

struct Orbit {
  double turn_rad = 0.6;        // about the sweep's own depth axis
  double rise_rad = 0.5;        // above its skin side; kept off the poles
  double zoom = 1;              // 1: the whole sweep fits
  Eigen::Vector2d slide{0, 0};  // of the middle, in parts of the window's smaller side
  bool operator==(const Orbit&) const = default;
};

// A finger's step in parts of the window's smaller side; one side is half a turn. Dragging right turns the
// near side to the right.
Orbit turned(const Orbit& orbit, double step_x, double step_y);
Orbit zoomed(const Orbit& orbit, double factor);
Orbit slid(const Orbit& orbit, double step_x, double step_y);

}  // namespace sonoband::ui
