// The Reslice window: the planar band, moved by fingers, with the curve on it.
#include <array>
#include <cmath>

#include "ui/interact/cross.h"
#include "ui/panels/contours.h"
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"
#include "ui/panels/point_marks.h"
#include "ui/panels/reslice_curve.h"
#include "ui/panels/windows.h"

namespace sonoband::ui {
namespace {

std::string_view short_name(Compounding c, const Texts& t) {
  if (c == Compounding::maximum) return t.maximum;
  return c == Compounding::minimum ? t.minimum : t.mean;
}

void move_plane(Ui& ui, const PlanePlace& place, const Gesture& g) {
  const auto step = [&](Vec2 px) -> Eigen::Vector2d { return Eigen::Vector2d(px.x, px.y) / place.px_per_mm; };
  switch (g.kind) {
    case Gesture::Kind::drag:
    case Gesture::Kind::two_finger_drag:
      ui.send(command::MovePlane{step(g.step)});
      break;
    case Gesture::Kind::pinch:
      ui.send(command::ZoomPlane{g.scale, place.mm(g.at)});
      break;
    case Gesture::Kind::twist:
      ui.send(command::TurnPlane{g.turn_rad, place.mm(g.at)});
      break;
    case Gesture::Kind::double_tap:
      ui.send(command::ResetPlane{});
      break;
    default:
      break;
  }
}

// A ball in the corner: a finger on it tilts the plane about the middle of the picture.
void draw_trackball(Ui& ui, const Rect& r, const PlanePlace& place) {
  const std::uint64_t id = ui.widgets.add("reslice/trackball", r);
  const bool held = ui.finger.down && ui.finger.target == id;
  const float radius = std::min(r.width, r.height) / 2 - ui.px(3);
  const Vec2 c = r.centre();
  const Colour ink = held ? colour::accent : colour::ink_quiet;
  ui.draw.disc(c, radius, colour::raised.with_alpha(0.75f));
  ui.draw.ring(c, radius, ink, ui.px(1.5f));
  // Two meridians and the equator make it read as a ball.
  for (const float squeeze : {0.45f, -0.45f}) {
    Vec2 last{};
    for (int i = 0; i <= 16; ++i) {
      const float a = -1.5708f + 3.14159f * static_cast<float>(i) / 16;
      const Vec2 p{c.x + squeeze * radius * std::cos(a), c.y + radius * std::sin(a)};
      if (i > 0) ui.draw.line(last, p, ink.with_alpha(0.7f), ui.px(1.2f));
      last = p;
    }
  }
  ui.draw.line({c.x - radius, c.y}, {c.x + radius, c.y}, ink.with_alpha(0.7f), ui.px(1.2f));
  for (const Gesture& g : ui.gestures) {
    if (g.target != id || g.kind != Gesture::Kind::drag) continue;
    // A radius of travel is half a radian: fine enough to set, far enough to reach any plane in a few
    // strokes.
    const double per_px = 0.5 / radius;
    ui.send(command::TiltPlane{-g.step.y * per_px, g.step.x * per_px, place.mm(place.r.centre())});
  }
}

// The strip at the right edge: a finger on it moves the plane along its normal, one mm on the screen per mm.
void draw_normal_strip(Ui& ui, const Rect& r, const PlanePlace& place) {
  const std::uint64_t id = ui.widgets.add("reslice/normal", r);
  const bool held = ui.finger.down && ui.finger.target == id;
  ui.draw.fill(r.inset(ui.px(6), 0), held ? colour::accent_ground : colour::raised, ui.px(10));
  const Colour ink = held ? colour::accent : colour::ink_quiet;
  const Vec2 c = r.centre();
  for (int i = -3; i <= 3; ++i) {
    if (i == 0) continue;
    const float y = c.y + static_cast<float>(i) * r.height / 8;
    const float half = ui.px(i % 2 == 0 ? 7 : 4.5f);
    ui.draw.line({c.x - half, y}, {c.x + half, y}, ink.with_alpha(0.7f), ui.px(1.5f));
  }
  ui.draw.disc(c, ui.px(11), held ? colour::accent : colour::pressed);
  const Colour sign = held ? colour::ink_on_accent : colour::ink;
  ui.draw.polyline(
      std::array<Vec2, 3>{
          {{c.x - ui.px(4), c.y - ui.px(2)}, {c.x, c.y - ui.px(6)}, {c.x + ui.px(4), c.y - ui.px(2)}}},
      sign, ui.px(1.8f));
  ui.draw.polyline(
      std::array<Vec2, 3>{
          {{c.x - ui.px(4), c.y + ui.px(2)}, {c.x, c.y + ui.px(6)}, {c.x + ui.px(4), c.y + ui.px(2)}}},
      sign, ui.px(1.8f));
  for (const Gesture& g : ui.gestures) {
    if (g.target == id && g.kind == Gesture::Kind::drag)
      ui.send(command::PushPlane{g.step.y / place.px_per_mm});
  }
}

void draw_reslice(Ui& ui, const Rect& window, Rect inside, const View& view) {
  const ReviewView& review = view.review;
  const double thickness = review.settings.band.thickness_mm;
  Rect strip = inside.cut_right(std::max(ui.metrics.target, ui.px(46)));
  if (is_low(ui, window)) strip.cut_top(window.y + ui.metrics.target - strip.y);  // the corner's place
  inside.cut_right(ui.px(4));

  const ReslicePlane& p = review.plane;
  PlanePlace place;
  place.r = inside;
  const double wide_mm = std::max(1, p.width) * p.pixel_mm;
  const double high_mm = std::max(1, p.height) * p.pixel_mm;
  place.px_per_mm = std::min(inside.width / wide_mm, inside.height / high_mm);
  place.corner_mm = {0.5 * (p.width - 1) * p.pixel_mm - 0.5 * inside.width / place.px_per_mm,
                     0.5 * (p.height - 1) * p.pixel_mm - 0.5 * inside.height / place.px_per_mm};

  // A plane of the window's shape fills it; a pixel's worth of rounding is no other shape.
  const double shape = inside.width / std::max(1.0f, inside.height);
  if (std::abs(shape * std::max(1, p.height) / std::max(1, p.width) - 1) > 0.02)
    ui.send(command::ShapePlane{shape});

  ui.draw.fill(inside, colour::no_data, ui.px(4));
  ui.draw.begin_clip(inside);
  ui.pictures.show(Slot::reslice, review.band);
  if (ui.draw.picture_width(Slot::reslice) > 0) {
    // The band may be a job behind the plane; drawn where its own pixels lie it stays under the finger while
    // the plane only slides or zooms.
    const ReslicePlane& b = review.band_plane;
    const Eigen::Vector2d first = on_plane(p, b.origin.v).mm - Eigen::Vector2d(0.5, 0.5) * b.pixel_mm;
    const Vec2 corner = place.at(first);
    const auto scale = static_cast<float>(b.pixel_mm * place.px_per_mm);
    ui.draw.picture(
        Slot::reslice,
        {corner.x, corner.y, scale * static_cast<float>(b.width), scale * static_cast<float>(b.height)},
        review.look);
  }
  if (review.current >= 0 && review.current < static_cast<int>(review.frames.size())) {
    if (const auto cross = crossing(*review.frames[review.current], p)) {
      ui.draw.line(place.at(cross->plane_mm[0]), place.at(cross->plane_mm[1]), colour::current, ui.px(2));
    }
  }
  draw_curve(ui, place, review.curve);
  const auto project = [&](const Eigen::Vector3d& w) { return place.at(on_plane(p, w).mm); };
  const double half_band = thickness / 2;
  for (const ContourView& c : review.contours) {
    if (!c.on_plane) continue;
    const float alpha = lies_in(c, p, half_band) ? 1.0f : 0.3f;  // behind or before the band: faint
    draw_contour(ui, c, colour::contour.with_alpha(alpha), project);
  }
  draw_marks(ui, review, project, [&](const Eigen::Vector3d& w) {
    return std::max(0.0, std::abs(on_plane(p, w).off_mm) - half_band);
  });
  draw_scale_bar(ui, inside, place.px_per_mm);
  const Sides sides = sides_of(review);
  draw_orientation_arms(ui, below_title(ui, window, inside), seen(sides.marked, p.right.v, p.down.v),
                        seen(sides.deep, p.right.v, p.down.v));
  ui.draw.end_clip();

  const std::uint64_t id = ui.widgets.add("reslice/picture", inside);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    const bool one_finger = g.kind == Gesture::Kind::drag || g.kind == Gesture::Kind::tap ||
                            g.kind == Gesture::Kind::double_tap || g.kind == Gesture::Kind::long_press;
    if (review.tool == Tool::curve && one_finger) {
      use_curve_tool(ui, review.curve, place, g);
    } else if (review.tool == Tool::contour && review.calibrated && one_finger) {
      use_contour_tool(
          ui, review, g, Window::reslice, [&](Vec2 at) { return from_plane(p, place.mm(at)); }, project,
          [&](const ContourView& c) { return lies_in(c, p, half_band); });
    } else if (sets_points(review) && (g.kind == Gesture::Kind::tap || g.kind == Gesture::Kind::long_press)) {
      use_point_tools(ui, review, g, from_plane(p, place.mm(g.start)), project);
    } else if (!(sets_points(review) && g.kind == Gesture::Kind::double_tap)) {
      move_plane(ui, place, g);
    }
  }
  tell_touching(ui, id);
  draw_normal_strip(ui, strip, place);
  tell_pushing(ui, id_of("reslice/normal"));
  if (review.tool == Tool::move) {
    const float side = ui.metrics.target;
    draw_trackball(ui, {inside.right() - side - ui.px(8), inside.bottom() - side - ui.px(8), side, side},
                   place);
    tell_touching(ui, id_of("reslice/trackball"));
  }
}

}  // namespace

void draw_reslice_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  const double thickness = review.settings.band.thickness_mm;
  Line detail = thickness > 0 ? Line(t.reslice_detail,
                                     {number(thickness, 1), short_name(review.settings.compounding, t)})
                              : Line(t.thin, {});
  if (review.band_left_out > 0) detail = Line(t.left_out, {number(review.band_left_out, 0)});
  if (review.band_coarse) detail = Line(t.coarse, {});
  const bool any = !review.frames.empty();
  const WindowTitle title{Window::reslice, "reslice/title", "reslice/corner", t.reslice,
                          any ? detail.view() : std::string_view()};
  const Rect inside = begin_window(ui, r, view, title);
  if (any) {
    draw_reslice(ui, r, inside, view);
  } else {
    empty_note(ui, inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
  }
  end_window(ui, r, view, title);
}

}  // namespace sonoband::ui
