#include "ui/panels/reslice_curve.h"

#include <cmath>

namespace sonoband::ui {
namespace {

void draw_polyline(Ui& ui, const PlanePlace& place, std::span<const Eigen::Vector2d> points, Colour c,
                   float width) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    ui.draw.line(place.at(points[i]), place.at(points[i + 1]), c, width);
  }
}

// Evenly dashed whatever the points' spacing.
void draw_dashed_polyline(Ui& ui, const PlanePlace& place, std::span<const Eigen::Vector2d> points, Colour c,
                          float width) {
  const float dash = ui.px(6);
  float travelled = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec2 a = place.at(points[i]);
    const Vec2 b = place.at(points[i + 1]);
    const float all = length(b - a);
    float t = 0;
    while (t < all) {
      const float into = std::fmod(travelled, 2 * dash);
      const float step = std::min(all - t, (into < dash ? dash : 2 * dash) - into + 0.01f);
      if (into < dash) ui.draw.line(a + (t / all) * (b - a), a + ((t + step) / all) * (b - a), c, width);
      t += step;
      travelled += step;
    }
  }
}

// The stretch from_mm..to_mm of the line's length.
void draw_stretch(Ui& ui, const PlanePlace& place, std::span<const Eigen::Vector2d> points, double from_mm,
                  double to_mm, Colour c, float width) {
  double s = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double step = (points[i + 1] - points[i]).norm();
    const double a = std::max(from_mm, s);
    const double b = std::min(to_mm, s + step);
    if (step > 0 && a < b) {
      ui.draw.line(place.at(points[i] + (a - s) / step * (points[i + 1] - points[i])),
                   place.at(points[i] + (b - s) / step * (points[i + 1] - points[i])), c, width);
    }
    s += step;
  }
}

int vertex_near(const PlanePlace& place, const CurveView& curve, Vec2 finger, float within) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(curve.vertices.size()); ++i) {
    const float d = length(place.at(curve.vertices[i]) - finger);
    if (d < within) {
      within = d;
      best = i;
    }
  }
  return best;
}

}  // namespace

void draw_curve(Ui& ui, const PlanePlace& place, const CurveView& curve) {
  for (const auto& extreme : {curve.up, curve.down}) {
    for (const PlaneLine& run : extreme)
      draw_dashed_polyline(ui, place, run, colour::accent.with_alpha(0.8f), ui.px(1.5f));
  }
  draw_polyline(ui, place, curve.line, colour::picture.with_alpha(0.5f), ui.px(5));
  draw_polyline(ui, place, curve.line, colour::accent, ui.px(3));
  for (const CurveView::Smear& s : curve.smeared) {
    draw_stretch(ui, place, curve.line, s.from_mm, s.to_mm, colour::smeared, ui.px(5));
  }
  if (curve.drawing) return;
  for (const Eigen::Vector2d& v : curve.vertices) {
    ui.draw.disc(place.at(v), ui.px(8), colour::ground.with_alpha(0.75f));
    ui.draw.ring(place.at(v), ui.px(8), colour::accent, ui.px(2.5f));
  }
}

// Which vertex a drag holds: the one nearest to where it began, before it was dragged away. While dragging
// the vertex is under the finger, so the one nearest to the last place of the finger is the same.
void use_curve_tool(Ui& ui, const CurveView& curve, const PlanePlace& place, const Gesture& g) {
  if (g.kind != Gesture::Kind::drag) return;
  const float reach = ui.metrics.target / 2;
  const bool begins = g.phase == Gesture::Phase::begin;
  if (begins) {
    const int held = vertex_near(place, curve, g.start, reach);
    if (held >= 0) {
      ui.send(command::GrabVertex{held});
      ui.send(command::DragVertex{held, place.mm(g.at)});
    } else {
      ui.send(command::BeginStroke{place.mm(g.start)});
      ui.send(command::ExtendStroke{place.mm(g.at)});
    }
    return;
  }
  if (curve.drawing) {
    if (g.phase == Gesture::Phase::change) ui.send(command::ExtendStroke{place.mm(g.at)});
    if (g.phase == Gesture::Phase::end) ui.send(command::EndStroke{});
    return;
  }
  if (g.phase == Gesture::Phase::change) ui.send(command::DragVertex{-1, place.mm(g.at)});
  if (g.phase == Gesture::Phase::end) ui.send(command::DropVertex{});
}

}  // namespace sonoband::ui
