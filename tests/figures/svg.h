// Line drawings for the paper's figures.
#pragma once

#include <fstream>
#include <string>

#include "core/manifold/plane_point.h"

namespace sonoband::figures {

struct Pen {
  std::string colour = "black";
  double width = 1;         // in user units
  std::string dashes = {};  // as stroke-dasharray
};

// Millimetres in, `scale` pixels each; y grows downwards as on the plane.
class Svg {
 public:
  Svg(const std::string& file, double width_mm, double height_mm, double scale);
  ~Svg();

  void line(const PlaneLine& points, const Pen& pen);
  void dot(const PlanePoint& at, double radius_px, const std::string& colour);
  void text(const PlanePoint& at, const std::string& words);

 private:
  std::ofstream out_;
  double scale_;
};

}  // namespace sonoband::figures
