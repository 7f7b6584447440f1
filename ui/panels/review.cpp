// The four linked windows of the paper's Figure 2, and the tools under them.
#include <cmath>

#include "ui/controls.h"
#include "ui/interact/cross.h"
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"

namespace sonoband::ui {
namespace {

// A point farther from a picture than this is not marked in it.
constexpr double mark_reach_mm = 1.5;

Icon corner_icon(const View& view, Window window) {
  return view.review.full == window ? Icon::shrink : Icon::grow;
}

void toggle_full(Ui& ui, const View& view, Window window, const PanelFrame& frame) {
  if (frame.title_tapped) ui.send(command::FillPage{view.review.full == window ? Window::none : window});
}

// From the pixels of a B-scan to the screen and back.
struct ImagePlace {
  Rect r;
  double scale = 1;  // screen pixels per picture pixel
  Vec2 at(const Eigen::Vector2d& px) const {
    return {r.x + static_cast<float>((px.x() + 0.5) * scale),
            r.y + static_cast<float>((px.y() + 0.5) * scale)};
  }
  Eigen::Vector2d px(Vec2 p) const { return {(p.x - r.x) / scale - 0.5, (p.y - r.y) / scale - 0.5}; }
};

bool sets_points(const ReviewView& review) {
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

Line value_of(const MeasureView& m, const Texts& t) {
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
    const bool has_value = m.finished || m.points_world.size() > 1;
    for (std::size_t i = 0; i < m.points_world.size(); ++i) {
      const bool labelled = i + 1 == m.points_world.size() && has_value;
      draw_point(ui, place(m.points_world[i]), colour::measure, labelled ? value_of(m, ui.texts) : Line());
    }
  }
}

// Of the sweep's middle B-scan, which stands for all: where its marked side is, and what lies deep.
struct Sides {
  Eigen::Vector3d marked;
  Eigen::Vector3d deep;
};
Sides sides_of(const ReviewView& review) {
  const auto& m = review.frames[review.frames.size() / 2]->world_from_image.linear;
  return {m.col(0).normalized(), m.col(1).normalized()};
}

Vec2 seen(const Eigen::Vector3d& direction, const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
  return {static_cast<float>(direction.dot(right)), static_cast<float>(direction.dot(down))};
}

std::string_view short_name(Compounding c, const Texts& t) {
  if (c == Compounding::maximum) return t.maximum;
  return c == Compounding::minimum ? t.minimum : t.mean;
}

}  // namespace

void draw_bscan_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  const auto count_frames = static_cast<int>(review.frames.size());
  const Line detail(t.bscan_of, {number(review.current + 1, 0), number(count_frames, 0)});
  const PanelFrame frame =
      panel(ui, "review/title", r, t.review, count_frames > 0 ? detail.view() : std::string_view(),
            corner_icon(view, Window::review));
  toggle_full(ui, view, Window::review, frame);
  ui.pictures.show(Slot::bscan, review.bscan);
  const float width = ui.draw.picture_width(Slot::bscan);
  if (count_frames == 0 || width <= 0 || review.current >= count_frames) {
    empty_note(ui, frame.inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
    return;
  }
  Rect inside = frame.inside;
  Rect foot = inside.cut_bottom(std::min(ui.metrics.target, inside.height * 0.3f));
  const Rect play = foot.cut_left(ui.metrics.target);
  ButtonLook look{review.playing ? Icon::pause : Icon::play, Role::quiet, false, true, false};
  if (button(ui, "review/play", play, "", look)) ui.send(command::Play{!review.playing});
  const Slide slide = slider(ui, "review/slider", foot, review.current, 0, std::max(1, count_frames - 1));
  if (slide.changed) ui.send(command::ShowFrame{static_cast<std::int32_t>(std::lround(slide.value))});

  ImagePlace place;
  place.r = fit(inside, width, ui.draw.picture_height(Slot::bscan));
  place.scale = place.r.width / width;
  ui.draw.begin_clip(inside);
  ui.draw.fill(place.r, colour::picture);
  ui.draw.picture(Slot::bscan, place.r, review.look);
  const TrackedFrame& f = *review.frames[review.current];
  const double mm_per_px = f.world_from_image.linear.col(1).norm();
  draw_depth_scale(ui, place.r, static_cast<float>(place.scale / mm_per_px));
  draw_orientation_mark(ui, place.r);
  if (const auto cross = crossing(f, review.plane)) {
    ui.draw.line(place.at(cross->image_px[0]), place.at(cross->image_px[1]), colour::plane, ui.px(2));
  }
  for (const ContourView& c : review.contours) {
    if (c.frame != review.current || c.points_px.empty()) continue;
    Vec2 last = place.at(c.points_px.front());
    for (std::size_t i = 1; i <= c.points_px.size(); ++i) {
      if (i == c.points_px.size() && !c.finished) break;
      const Vec2 at = place.at(c.points_px[i % c.points_px.size()]);
      ui.draw.line(last, at, colour::contour, ui.px(2));
      last = at;
    }
    if (c.finished && c.area_mm2 > 0) {
      draw_badge(ui, place.at(c.points_px.front()) + Vec2{0, -ui.px(22)}, colour::contour,
                 Line(t.square_millimetres, {number(c.area_mm2, 0)}));
    }
  }
  const auto project = [&](const Eigen::Vector3d& w) { return place.at(on_image(f, w).px); };
  draw_marks(ui, review, project, [&](const Eigen::Vector3d& w) { return on_image(f, w).off_mm; });
  ui.draw.end_clip();

  const std::uint64_t id = ui.widgets.add("review/picture", inside);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    use_point_tools(ui, review, g, from_image(f, place.px(g.start)), project);
    if (review.tool == Tool::contour && review.calibrated) {
      if (g.kind == Gesture::Kind::drag) {
        const Eigen::Vector2d at = place.px(g.at);
        if (g.phase == Gesture::Phase::begin) ui.send(command::BeginContour{place.px(g.start)});
        if (g.phase != Gesture::Phase::end) ui.send(command::ExtendContour{at});
        if (g.phase == Gesture::Phase::end) ui.send(command::EndContour{});
      }
      if (g.kind == Gesture::Kind::long_press) ui.send(command::RemoveContour{});
      continue;
    }
    if (g.kind == Gesture::Kind::flick && std::abs(g.velocity.x) > std::abs(g.velocity.y)) {
      ui.send(command::Fling{g.velocity.x / std::max(1.0f, inside.width) * count_frames * 0.5});
    } else if (g.kind == Gesture::Kind::drag && g.phase != Gesture::Phase::end) {
      // The whole width of the window is half of the sweep.
      const double now = 0.5 * count_frames * (g.at.x - g.start.x) / std::max(1.0f, inside.width);
      const double before =
          0.5 * count_frames * (g.at.x - g.step.x - g.start.x) / std::max(1.0f, inside.width);
      const auto by = static_cast<std::int32_t>(std::lround(now) - std::lround(before));
      if (by != 0) ui.send(command::StepFrames{by});
    }
  }
}

namespace {

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

void tell_touching(Ui& ui, std::uint64_t id) {
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    if (g.phase == Gesture::Phase::begin) ui.send(command::Touching{true});
    if (g.phase == Gesture::Phase::end) ui.send(command::Touching{false});
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
  if (review.band_coarse) detail = Line(t.coarse, {});
  const bool any = !review.frames.empty();
  const PanelFrame frame = panel(ui, "reslice/title", r, t.reslice, any ? detail.view() : std::string_view(),
                                 corner_icon(view, Window::reslice));
  toggle_full(ui, view, Window::reslice, frame);
  if (!any) {
    empty_note(ui, frame.inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
    return;
  }
  Rect inside = frame.inside;
  const Rect strip = inside.cut_right(std::max(ui.metrics.target * 0.8f, ui.px(46)));
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
  draw_marks(ui, review, project, [&](const Eigen::Vector3d& w) {
    return std::max(0.0, std::abs(on_plane(p, w).off_mm) - half_band);
  });
  draw_scale_bar(ui, inside, place.px_per_mm);
  const Sides sides = sides_of(review);
  draw_orientation_arms(ui, inside, seen(sides.marked, p.right.v, p.down.v),
                        seen(sides.deep, p.right.v, p.down.v));
  ui.draw.end_clip();

  const std::uint64_t id = ui.widgets.add("reslice/picture", inside);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    const bool one_finger = g.kind == Gesture::Kind::drag || g.kind == Gesture::Kind::tap ||
                            g.kind == Gesture::Kind::double_tap || g.kind == Gesture::Kind::long_press;
    if (review.tool == Tool::curve && one_finger) {
      use_curve_tool(ui, review.curve, place, g);
    } else if (sets_points(review) && (g.kind == Gesture::Kind::tap || g.kind == Gesture::Kind::long_press)) {
      use_point_tools(ui, review, g, from_plane(p, place.mm(g.start)), project);
    } else if (!(sets_points(review) && g.kind == Gesture::Kind::double_tap)) {
      move_plane(ui, place, g);
    }
  }
  tell_touching(ui, id);
  draw_normal_strip(ui, strip, place);
  tell_touching(ui, id_of("reslice/normal"));
  if (review.tool == Tool::move) {
    const float side = ui.metrics.target;
    draw_trackball(ui, {inside.right() - side - ui.px(8), inside.bottom() - side - ui.px(8), side, side},
                   place);
    tell_touching(ui, id_of("reslice/trackball"));
  }
}

void draw_manifold_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  ui.pictures.show(Slot::manifold, review.manifold);
  const float width = ui.draw.picture_width(Slot::manifold);
  const bool any = width > 0;
  Line detail(t.manifold_detail, {number(review.manifold_thickness_mm, 1), number(review.curve.reach_mm, 0),
                                  number(review.curve.layers, 0)});
  if (review.manifold_coarse) detail = Line(t.coarse, {});
  const PanelFrame frame =
      panel(ui, "manifold/title", r, t.manifold, any ? detail.view() : std::string_view(),
            corner_icon(view, Window::manifold));
  toggle_full(ui, view, Window::manifold, frame);
  if (!any) {
    empty_note(ui, frame.inside, Icon::curve, colour::ink_quiet,
               review.frames.empty() ? t.no_sweep : t.no_curve,
               review.frames.empty() ? t.no_sweep_cure : t.no_curve_cure);
    return;
  }
  Rect inside = frame.inside;
  // The handle sits on the picture's lower edge: pulling it down makes the surface higher (the paper resizes
  // the window for the same).
  const float handle_height = std::min(ui.metrics.target * 0.6f, inside.height * 0.25f);
  inside.cut_bottom(handle_height);
  const float height = ui.draw.picture_height(Slot::manifold);
  const Rect place = fit(inside, width, height);
  const Rect handle{place.x, place.bottom(), place.width, handle_height};
  ui.draw.fill(place, colour::no_data);
  ui.draw.picture(Slot::manifold, place, review.look);
  const double px_per_mm =
      review.manifold_pixel_mm > 0 ? place.width / (width * review.manifold_pixel_mm) : 0;
  float labelled_to = place.x;
  for (const CurveView::Smear& s : review.curve.smeared) {
    // s runs down the picture when rows are rulings, so a smeared stretch is a band across it.
    const double length_mm = std::max(1e-6, review.curve.length_mm);
    const auto x0 = static_cast<float>(place.x + place.width * s.from_mm / length_mm);
    const auto x1 = static_cast<float>(place.x + place.width * s.to_mm / length_mm);
    ui.draw.begin_clip(place);
    ui.draw.fill({x0, place.y, std::max(ui.px(2), x1 - x0), place.height}, colour::smeared.with_alpha(0.25f));
    const float words = ui.draw.width_of(Type::small, t.smeared) + ui.px(8);
    if (x0 >= labelled_to && x0 + words < place.right()) {
      ui.draw.text({x0 + ui.px(3), place.y + ui.px(4)}, Type::small, colour::smeared, t.smeared);
      labelled_to = x0 + words;
    }
    ui.draw.end_clip();
  }
  if (px_per_mm > 0) draw_scale_bar(ui, place, px_per_mm);
  // Rows run along the plane's normal; where the columns point changes with the curve.
  const Eigen::Vector3d across = Eigen::Vector3d::Zero();
  const Sides sides = sides_of(review);
  draw_orientation_arms(ui, place, seen(sides.marked, across, review.plane.normal().v),
                        seen(sides.deep, across, review.plane.normal().v));

  const std::uint64_t id = ui.widgets.add("manifold/reach", handle);
  const bool held = ui.finger.down && ui.finger.target == id;
  const Vec2 c = handle.centre();
  ui.draw.fill({c.x - ui.px(44), c.y - ui.px(3), ui.px(88), ui.px(6)},
               held ? colour::accent : colour::ink_quiet, ui.px(3));
  for (const Gesture& g : ui.gestures) {
    if (g.target != id || g.kind != Gesture::Kind::drag || !(px_per_mm > 0)) continue;
    // The picture is 2 r high and stays centred.
    ui.send(command::SetReach{std::max(1.0, review.curve.reach_mm + g.step.y / px_per_mm)});
  }
  ui.widgets.add("manifold/picture", inside);
  tell_touching(ui, id);
}

void draw_outline_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  const bool any = !review.frames.empty();
  const PanelFrame frame = panel(ui, "outline/title", r, t.outline, any ? t.tap_outline : std::string_view(),
                                 corner_icon(view, Window::outline));
  toggle_full(ui, view, Window::outline, frame);
  if (!any) {
    empty_note(ui, frame.inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
    return;
  }
  SceneInput scene;
  scene.frames = review.frames;
  scene.frames_version = review.sweep_version;
  scene.current = review.current;
  scene.plane = review.plane;
  scene.thickness_mm = review.settings.band.thickness_mm;
  scene.band_on_plane = review.band.version != 0;
  scene.band_plane = review.band_plane;
  scene.band_version = review.band.version;
  scene.curve_mm = review.curve.line;
  scene.reach_mm = review.curve.reach_mm;
  scene.orbit = review.orbit;
  scene.look = review.look;
  const Rect place = frame.inside;
  ui.draw.texture(
      ui.scene.render(scene, static_cast<int>(place.width), static_cast<int>(place.height), ui.px(1)), place);
  const OutlineView eye = ui.scene.view(scene, place);
  ui.draw.begin_clip(place);
  for (const ContourView& c : review.contours) {
    if (c.frame < 0 || c.frame >= static_cast<int>(review.frames.size())) continue;
    const TrackedFrame& f = *review.frames[c.frame];
    for (std::size_t i = 0; i + (c.finished ? 0 : 1) < c.points_px.size(); ++i) {
      ui.draw.line(eye.at(from_image(f, c.points_px[i])),
                   eye.at(from_image(f, c.points_px[(i + 1) % c.points_px.size()])), colour::contour,
                   ui.px(1.5f));
    }
  }
  draw_marks(
      ui, review, [&](const Eigen::Vector3d& w) { return eye.at(w); },
      [](const Eigen::Vector3d&) { return 0.0; });
  draw_scale_bar(ui, place, eye.px_per_mm());
  const Sides sides = sides_of(review);
  const Eigen::Matrix3d& e = eye.eye_from_world();
  draw_orientation_arms(ui, place, seen(sides.marked, e.row(0), e.row(1)),
                        seen(sides.deep, e.row(0), e.row(1)));
  ui.draw.end_clip();
  orbit_by_gestures(ui, "outline/picture", place, review.orbit);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id_of("outline/picture") || g.kind != Gesture::Kind::tap) continue;
    if (const auto i = pick_outline(review.frames, eye, g.at, ui.metrics.target / 2))
      ui.send(command::ShowFrame{*i});
  }
}

void draw_review(Ui& ui, const Rect& r, const View& view) {
  Rect rest = r;
  const float gap = ui.px(8);
  const float line = std::max(ui.metrics.target, ui.px(50));
  draw_tools(ui, rest.cut_bottom(2 * line + gap), view);
  rest.cut_bottom(gap);
  switch (view.review.full) {
    case Window::review:
      return draw_bscan_window(ui, rest, view);
    case Window::reslice:
      return draw_reslice_window(ui, rest, view);
    case Window::manifold:
      return draw_manifold_window(ui, rest, view);
    case Window::outline:
      return draw_outline_window(ui, rest, view);
    case Window::none:
      break;
  }
  const Rect above = row(rest, 0, 2, gap);
  const Rect below = row(rest, 1, 2, gap);
  draw_bscan_window(ui, column(above, 0, 2, gap), view);
  draw_reslice_window(ui, column(above, 1, 2, gap), view);
  draw_manifold_window(ui, column(below, 0, 2, gap), view);
  draw_outline_window(ui, column(below, 1, 2, gap), view);
}

}  // namespace sonoband::ui
