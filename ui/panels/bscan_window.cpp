// The Review window: one B-scan, scrubbed by a slider and by flicks, with what lies in it.
#include <cmath>

#include "ui/interact/cross.h"
#include "ui/panels/contours.h"
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"
#include "ui/panels/point_marks.h"
#include "ui/panels/windows.h"

namespace sonoband::ui {
namespace {

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

// The slider and what plays: under the picture, in a low window beside it.
void draw_scrubber(Ui& ui, const ReviewView& review, const Rect& play, const Rect& groove, bool upright) {
  if (upright) ui.draw.fill(play, colour::panel.with_alpha(0.72f), ui.px(8));
  const ButtonLook look{review.playing ? Icon::pause : Icon::play, Role::quiet, false, true, false};
  if (button(ui, "review/play", play, "", look)) ui.send(command::Play{!review.playing});
  const auto last = static_cast<int>(review.frames.size()) - 1;
  const Slide slide = slider(ui, "review/slider", groove, review.current, 0, std::max(1, last), upright);
  if (slide.changed) ui.send(command::ShowFrame{static_cast<std::int32_t>(std::lround(slide.value))});
}

void draw_bscan(Ui& ui, const Rect& window, Rect inside, const ReviewView& review) {
  const auto count_frames = static_cast<int>(review.frames.size());
  const float width = ui.draw.picture_width(Slot::bscan);
  const float side = ui.metrics.target;
  const bool low = is_low(ui, window);
  Rect groove = low ? inside.cut_right(side) : inside.cut_bottom(std::min(side, inside.height * 0.3f));
  if (low) groove.cut_top(window.y + side - groove.y);  // the corner's place
  const Rect play = low ? Rect{inside.x, inside.bottom() - side, side, side} : groove.cut_left(side);

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
  const auto project = [&](const Eigen::Vector3d& w) { return place.at(on_image(f, w).px); };
  const auto on_this = [&](const ContourView& c) { return c.frame == review.current; };
  for (const ContourView& c : review.contours)
    if (on_this(c)) draw_contour(ui, c, colour::contour, project);
  draw_marks(ui, review, project, [&](const Eigen::Vector3d& w) { return on_image(f, w).off_mm; });
  ui.draw.end_clip();

  const std::uint64_t id = ui.widgets.add("review/picture", inside);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    use_point_tools(ui, review, g, from_image(f, place.px(g.start)), project);
    if (review.tool == Tool::contour && review.calibrated) {
      use_contour_tool(
          ui, review, g, Window::review, [&](Vec2 at) { return from_image(f, place.px(at)); }, project,
          on_this);
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
  draw_scrubber(ui, review, play, groove, low);
}

}  // namespace

void draw_bscan_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  const auto count_frames = static_cast<int>(review.frames.size());
  const Line detail(t.bscan_of, {number(review.current + 1, 0), number(count_frames, 0)});
  const WindowTitle title{Window::review, "review/title", "review/corner", t.review,
                          count_frames > 0 && !is_low(ui, r) ? detail.view() : std::string_view()};
  const Rect inside = begin_window(ui, r, view, title);
  ui.pictures.show(Slot::bscan, review.bscan);
  if (count_frames == 0 || ui.draw.picture_width(Slot::bscan) <= 0 || review.current >= count_frames) {
    empty_note(ui, inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
  } else {
    draw_bscan(ui, r, inside, review);
  }
  end_window(ui, r, view, title);
}

}  // namespace sonoband::ui
