// Contours in the windows, as drawn and as drawn by a finger. `place` projects a point of World into the
// window.
#pragma once

#include <cmath>

#include "ui/panels/marks.h"
#include "ui/panels/point_marks.h"
#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// Whether it was drawn on a plane, and all of it lies within reach of the band on this one.
bool lies_in(const ContourView& contour, const ReslicePlane& plane, double half_band_mm);
// Whether the Review or the Reslice window shows it as lying in its picture.
bool in_sight(const ContourView& contour, const ReviewView& review);

// With its area once it is closed.
void draw_contour(Ui& ui, const ContourView& contour, Colour c, auto&& place) {
  const auto& points = contour.points_world;
  if (points.empty()) return;
  Vec2 last = place(points.front());
  for (std::size_t i = 1; i <= points.size(); ++i) {
    if (i == points.size() && !contour.finished) break;
    const Vec2 at = place(points[i % points.size()]);
    ui.draw.line(last, at, c, ui.px(2));
    last = at;
  }
  if (contour.finished && contour.area_mm2 > 0)
    draw_badge(ui, place(points.front()) + Vec2{0, -ui.px(22)}, c,
               Line(ui.texts.square_millimetres, {number(contour.area_mm2, 0)}));
}

// The number of the one among those `wanted` that a finger is on or in: the nearest line counts. 0: none.
int contour_under(const ReviewView& review, Vec2 finger, float within, auto&& place, auto&& wanted) {
  int best = 0;
  for (const ContourView& c : review.contours) {
    if (!c.finished || !wanted(c) || c.points_world.empty()) continue;
    bool inside = false;
    float nearest = within;
    Vec2 b = place(c.points_world.back());
    for (const Eigen::Vector3d& p : c.points_world) {
      const Vec2 a = place(p);
      if ((a.y > finger.y) != (b.y > finger.y) &&
          finger.x < (b.x - a.x) * (finger.y - a.y) / (b.y - a.y) + a.x)
        inside = !inside;
      nearest = std::min(nearest, length(a - finger));
      b = a;
    }
    if (nearest < within || (inside && best == 0)) {
      best = c.number;
      within = nearest;
    }
  }
  return best;
}

// What the contour tool makes of a gesture in `window`, in which `world` gives the point under a finger.
void use_contour_tool(Ui& ui, const ReviewView& review, const Gesture& g, Window window, auto&& world,
                      auto&& place, auto&& wanted) {
  if (g.kind == Gesture::Kind::drag) {
    if (g.phase == Gesture::Phase::begin) ui.send(command::BeginContour{world(g.start), window});
    if (g.phase != Gesture::Phase::end) ui.send(command::ExtendContour{world(g.at)});
    if (g.phase == Gesture::Phase::end) ui.send(command::EndContour{});
  }
  if (g.kind == Gesture::Kind::long_press) {
    const int number = contour_under(review, g.start, ui.metrics.target / 2, place, wanted);
    if (number > 0) ui.send(command::RemoveContour{number});
  }
}

}  // namespace sonoband::ui
