#include "ui/panels/windows.h"

#include <algorithm>

namespace sonoband::ui {
namespace {

constexpr float low_units = 240;
constexpr float chip_units = 34;  // the height of a title over a picture
constexpr float edge_units = 6;   // between a low window's edge and what is in it
constexpr Colour over_picture = colour::panel.with_alpha(0.72f);

bool tapped(const Ui& ui, std::uint64_t id) {
  return std::any_of(ui.gestures.begin(), ui.gestures.end(),
                     [&](const Gesture& g) { return g.kind == Gesture::Kind::tap && g.target == id; });
}

bool held(const Ui& ui, std::string_view name) {
  return ui.finger.down && ui.finger.target == id_of(name);
}

Icon corner_icon(const View& view, Window window) {
  return view.review.full == window ? Icon::shrink : Icon::grow;
}

// Title, detail and corner, each on a ground that lets the picture through.
void draw_title_over(Ui& ui, const Rect& r, const View& view, const WindowTitle& title, float corner) {
  const float pad = ui.px(10);
  const float height = ui.px(chip_units);
  const float top = r.y + ui.px(edge_units);
  const auto ground = [&](const Rect& chip, bool pressed) {
    ui.draw.fill(chip, pressed ? colour::raised : over_picture, ui.px(8));
  };
  const Rect words{r.x + ui.px(edge_units), top, ui.draw.width_of(Type::strong, title.title) + 2 * pad,
                   height};
  ground(words, held(ui, title.name));
  ui.draw.text_in(words, Align::centre, Type::strong, colour::ink, title.title);
  const Rect mark{r.right() - ui.px(edge_units) - height, top, height, height};
  ground(mark, held(ui, title.corner_name));
  ui.draw.icon(mark.centre(), ui.px(14), colour::ink, corner_icon(view, title.window));
  if (title.detail.empty()) return;
  const float room = r.right() - corner - words.right() - ui.px(8);
  const float width = std::min(room, ui.draw.width_of(Type::small, title.detail) + 2 * pad);
  if (width < ui.px(60)) return;
  const Rect detail{r.right() - corner - width, top, width, height};
  ground(detail, false);
  ui.draw.text_in(detail.inset(pad, 0), Align::right, Type::small, colour::ink, title.detail);
}

}  // namespace

bool is_low(const Ui& ui, const Rect& window) {
  return window.height < ui.px(low_units);
}

Rect begin_window(Ui& ui, const Rect& r, const View& view, const WindowTitle& title) {
  if (is_low(ui, r)) {
    ui.draw.fill(r, colour::panel, ui.px(8));
    return r.inset(ui.px(edge_units));
  }
  const Rect inside = panel(ui, r, title.title, title.detail, corner_icon(view, title.window));
  if (held(ui, title.name))
    ui.draw.outline({r.x, r.y, r.width, inside.y - r.y}, colour::accent, ui.px(1.5f), ui.px(8));
  return inside;
}

void end_window(Ui& ui, const Rect& r, const View& view, const WindowTitle& title) {
  const float side = ui.metrics.target;
  bool fills = false;
  if (is_low(ui, r)) {
    // A finger's breadth for each; between them the picture is touched.
    const float words = ui.draw.width_of(Type::strong, title.title) + ui.px(20 + edge_units);
    const std::uint64_t left = ui.widgets.add(title.name, {r.x, r.y, std::max(side, words), side});
    const std::uint64_t right = ui.widgets.add(title.corner_name, {r.right() - side, r.y, side, side});
    fills = tapped(ui, left) || tapped(ui, right);
    draw_title_over(ui, r, view, title, side);
  } else {
    // The bar alone is lower than a finger is wide.
    fills = tapped(ui, ui.widgets.add(title.name, {r.x, r.y, r.width, side}));
  }
  if (!fills) return;
  ui.send(command::FillPage{view.review.full == title.window ? Window::none : title.window});
}

Rect beside_title(const Ui& ui, const Rect& window) {
  const float inset = ui.px(edge_units + 10);
  return {window.x + inset, window.y + ui.metrics.target, window.width * 0.27f, window.height / 2};
}

Rect below_title(const Ui& ui, const Rect& window, const Rect& inside) {
  Rect rest = inside;
  if (is_low(ui, window)) rest.cut_top(ui.px(chip_units));
  return rest;
}

void tell_touching(Ui& ui, std::uint64_t id) {
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    if (g.phase == Gesture::Phase::begin) ui.send(command::Touching{true});
    if (g.phase == Gesture::Phase::end) ui.send(command::Touching{false});
  }
}

void tell_pushing(Ui& ui, std::uint64_t id) {
  for (const Gesture& g : ui.gestures)
    if (g.target == id && g.kind == Gesture::Kind::press) ui.send(command::AboutToPush{});
  tell_touching(ui, id);
}

Sides sides_of(const ReviewView& review) {
  const auto& m = review.frames[review.frames.size() / 2]->world_from_image.linear;
  return {m.col(0).normalized(), m.col(1).normalized()};
}

Vec2 seen(const Eigen::Vector3d& direction, const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
  return {static_cast<float>(direction.dot(right)), static_cast<float>(direction.dot(down))};
}

}  // namespace sonoband::ui
