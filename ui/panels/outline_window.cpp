// The Outline window: the sweep in space, with what was set and drawn in it.
#include "ui/interact/cross.h"
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"
#include "ui/panels/point_marks.h"
#include "ui/panels/windows.h"

namespace sonoband::ui {

namespace {

void draw_outline(Ui& ui, const Rect& window, const Rect& place, const View& view) {
  const ReviewView& review = view.review;
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
  ui.draw.scene(
      ui.scene.render(scene, static_cast<int>(place.width), static_cast<int>(place.height), ui.px(1)), place);
  const OutlineView eye = ui.scene.view(scene, place);
  ui.draw.begin_clip(place);
  for (const ContourView& c : review.contours) {
    for (std::size_t i = 0; i + (c.finished ? 0 : 1) < c.points_world.size(); ++i) {
      ui.draw.line(eye.at(c.points_world[i]), eye.at(c.points_world[(i + 1) % c.points_world.size()]),
                   colour::contour, ui.px(1.5f));
    }
  }
  draw_marks(
      ui, review, [&](const Eigen::Vector3d& w) { return eye.at(w); },
      [](const Eigen::Vector3d&) { return 0.0; });
  draw_scale_bar(ui, place, eye.px_per_mm());
  const Sides sides = sides_of(review);
  const Eigen::Matrix3d& e = eye.eye_from_world();
  draw_orientation_arms(ui, below_title(ui, window, place), seen(sides.marked, e.row(0), e.row(1)),
                        seen(sides.deep, e.row(0), e.row(1)));
  ui.draw.end_clip();
  orbit_by_gestures(ui, "outline/picture", place, review.orbit);
  for (const Gesture& g : ui.gestures) {
    if (g.target != id_of("outline/picture") || g.kind != Gesture::Kind::tap) continue;
    if (const auto i = pick_outline(review.frames, eye, g.at, ui.metrics.target / 2))
      ui.send(command::ShowFrame{*i});
  }
}

}  // namespace

void draw_outline_window(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const bool any = !view.review.frames.empty();
  const WindowTitle title{Window::outline, "outline/title", "outline/corner", t.outline,
                          any && !is_low(ui, r) ? t.tap_outline : std::string_view()};
  const Rect inside = begin_window(ui, r, view, title);
  if (any) {
    draw_outline(ui, r, inside, view);
  } else {
    empty_note(ui, inside, Icon::review, colour::ink_quiet, t.no_sweep, t.no_sweep_cure);
  }
  end_window(ui, r, view, title);
}

}  // namespace sonoband::ui
