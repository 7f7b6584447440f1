// The curve c(s) in the Reslice window: drawn, and worked by a finger.
#pragma once

#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// Reslice: from mm of the plane to the screen. The picture of the plane fills the window as far as it fits.
struct PlanePlace {
  Rect r;
  double px_per_mm = 1;
  Eigen::Vector2d corner_mm{0, 0};  // at the top left of r
  Vec2 at(const Eigen::Vector2d& mm) const {
    const Eigen::Vector2d p = px_per_mm * (mm - corner_mm);
    return {r.x + static_cast<float>(p.x()), r.y + static_cast<float>(p.y())};
  }
  Eigen::Vector2d mm(Vec2 p) const { return corner_mm + Eigen::Vector2d(p.x - r.x, p.y - r.y) / px_per_mm; }
};

// With the extreme curves of the band, the smeared stretches and the vertices that can be dragged.
void draw_curve(Ui& ui, const PlanePlace& place, const CurveView& curve);

// What the curve tool makes of a drag: a stroke, or the dragging of a vertex.
void use_curve_tool(Ui& ui, const CurveView& curve, const PlanePlace& place, const Gesture& g);

}  // namespace sonoband::ui
