// The Manifold window: the unrolled non-planar band.
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"
#include "ui/panels/windows.h"

namespace sonoband::ui {
namespace {

void draw_manifold(Ui& ui, const Rect& window, Rect inside, const View& view, std::string_view detail) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  const float width = ui.draw.picture_width(Slot::manifold);
  // The handle sits on the picture's lower edge: pulling it down makes the surface higher (the paper resizes
  // the window for the same).
  const float handle_height = std::min(ui.metrics.target * 0.6f, inside.height * 0.25f);
  inside.cut_bottom(handle_height);
  const float height = ui.draw.picture_height(Slot::manifold);
  const Rect place = fit(inside, width, height);
  const Rect handle{place.x, place.bottom(), place.width, handle_height};
  if (is_low(ui, window)) {
    const Rect words = beside_title(ui, window);
    if (words.right() < place.x) ui.draw.paragraph(words, Type::small, colour::ink_quiet, detail);
  }
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
  draw_orientation_arms(ui, below_title(ui, window, place),
                        seen(sides.marked, across, review.plane.normal().v),
                        seen(sides.deep, across, review.plane.normal().v));

  ui.widgets.add("manifold/picture", inside);
  // A finger may land on the picture's foot as well: the handle alone is lower than a finger is wide.
  const float side = ui.metrics.target;
  const float wide = std::max({handle.width, ui.px(88), side});
  const std::uint64_t id =
      ui.widgets.add("manifold/reach", {handle.centre().x - wide / 2, handle.bottom() - side, wide, side});
  const bool held = ui.finger.down && ui.finger.target == id;
  const Vec2 c = handle.centre();
  ui.draw.fill({c.x - ui.px(44), c.y - ui.px(3), ui.px(88), ui.px(6)},
               held ? colour::accent : colour::ink_quiet, ui.px(3));
  for (const Gesture& g : ui.gestures) {
    if (g.target != id || g.kind != Gesture::Kind::drag || !(px_per_mm > 0)) continue;
    // The picture is 2 r high and stays centred.
    ui.send(command::SetReach{std::max(1.0, review.curve.reach_mm + g.step.y / px_per_mm)});
  }
  tell_touching(ui, id);
}

}  // namespace

void draw_manifold_window(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Texts& t = ui.texts;
  ui.pictures.show(Slot::manifold, review.manifold);
  const bool any = ui.draw.picture_width(Slot::manifold) > 0;
  Line detail(t.manifold_detail, {number(review.manifold_thickness_mm, 1), number(review.curve.reach_mm, 0),
                                  number(review.curve.layers, 0)});
  if (review.manifold_coarse) detail = Line(t.coarse, {});
  const WindowTitle title{Window::manifold, "manifold/title", "manifold/corner", t.manifold,
                          any && !is_low(ui, r) ? detail.view() : std::string_view()};
  const Rect inside = begin_window(ui, r, view, title);
  if (any) {
    draw_manifold(ui, r, inside, view, detail);
  } else {
    empty_note(ui, inside, Icon::curve, colour::ink_quiet, review.frames.empty() ? t.no_sweep : t.no_curve,
               review.frames.empty() ? t.no_sweep_cure : t.no_curve_cure);
  }
  end_window(ui, r, view, title);
}

}  // namespace sonoband::ui
