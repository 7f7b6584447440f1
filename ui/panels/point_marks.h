// Landmarks and measurements in the windows, as drawn and as set by a finger. `place` projects a point of
// World into the window, `off` says how far it is from the picture there, mm.
#pragma once

#include <cmath>

#include "ui/panels/marks.h"
#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// A point farther from a picture than this is not marked in it.
constexpr double mark_reach_mm = 1.5;

inline bool sets_points(const ReviewView& review) {
  return review.calibrated && (review.tool == Tool::landmark || review.tool == Tool::measure);
}

int landmark_near(const ReviewView& review, Vec2 finger, float within, auto&& place) {
  int best = -1;
  for (const LandmarkView& l : review.landmarks) {
    const float d = length(place(l.at_world) - finger);
    if (d < within) {
      within = d;
      best = l.number;
    }
  }
  return best;
}

// What the tools do with a tap or a long press on a picture in which `world` is the point under the finger.
void use_point_tools(Ui& ui, const ReviewView& review, const Gesture& g, const Eigen::Vector3d& world,
                     auto&& place) {
  if (!sets_points(review)) return;
  if (g.kind == Gesture::Kind::tap) {
    if (review.tool == Tool::landmark) ui.send(command::PlaceLandmark{world});
    if (review.tool == Tool::measure) ui.send(command::AddMeasurePoint{world});
  }
  if (g.kind == Gesture::Kind::long_press && review.tool == Tool::landmark) {
    const int number = landmark_near(review, g.start, ui.metrics.target / 2, place);
    if (number >= 0) ui.send(command::RemoveLandmark{number});
  }
}

inline Line value_of(const MeasureView& m, const Texts& t) {
  switch (m.kind) {
    case Measure::distance:
      return {t.millimetres, {number(m.value, 1)}};
    case Measure::angle:
      return {t.degrees, {number(m.value, 0)}};
    case Measure::area:
      break;
  }
  return {t.square_millimetres, {number(m.value, 0)}};
}

// Marks and measurements in a picture: `place` projects, `off` says how far a point is from the picture, in
// mm.
void draw_marks(Ui& ui, const ReviewView& review, auto&& place, auto&& off) {
  for (const LandmarkView& l : review.landmarks) {
    const double away = std::abs(off(l.at_world));
    const float alpha = away <= mark_reach_mm ? 1.0f : 0.3f;  // behind or before the picture: faint
    draw_point(ui, place(l.at_world), colour::landmark.with_alpha(alpha), Line("{0}", {number(l.number, 0)}));
  }
  for (const MeasureView& m : review.measures) {
    if (m.points_world.empty()) continue;
    const bool closed = m.kind == Measure::area && m.finished;
    Vec2 last = place(m.points_world.front());
    for (std::size_t i = 0; i < m.points_world.size(); ++i) {
      const Vec2 at = place(m.points_world[i]);
      if (i > 0) ui.draw.line(last, at, colour::measure, ui.px(2));
      last = at;
    }
    if (closed) ui.draw.line(last, place(m.points_world.front()), colour::measure, ui.px(2));
    Vec2 rightmost = last;
    for (const Eigen::Vector3d& point : m.points_world) {
      const Vec2 at = place(point);
      if (at.x > rightmost.x) rightmost = at;
      draw_point(ui, at, colour::measure, {});
    }
    if (m.finished || m.points_world.size() > 1)
      draw_tag(ui, rightmost, colour::measure, value_of(m, ui.texts));
  }
}

}  // namespace sonoband::ui
