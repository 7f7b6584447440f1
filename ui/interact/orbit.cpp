#include "ui/interact/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonoband::ui {

Orbit turned(const Orbit& orbit, double step_x, double step_y) {
  constexpr double pi = std::numbers::pi;
  constexpr double steepest = 0.49 * pi;  // at the pole a turn would roll the picture
  Orbit out = orbit;
  out.turn_rad = std::remainder(orbit.turn_rad + step_x * pi, 2 * pi);
  out.rise_rad = std::clamp(orbit.rise_rad + step_y * pi, -steepest, steepest);
  return out;
}

Orbit zoomed(const Orbit& orbit, double factor) {
  Orbit out = orbit;
  out.zoom = std::clamp(orbit.zoom * factor, 0.3, 12.0);
  return out;
}

Orbit slid(const Orbit& orbit, double step_x, double step_y) {
  Orbit out = orbit;
  out.slide += Eigen::Vector2d(step_x, step_y);
  out.slide = out.slide.cwiseMax(-3.0).cwiseMin(3.0);
  return out;
}

}  // namespace sonoband::ui
