#include "ui/panels/sheet.h"

#include <algorithm>
#include <cmath>

#include "ui/controls.h"

namespace sonoband::ui {

Rect sheet_paper(Ui& ui, float width, float height, std::string_view title, bool can_close) {
  const Rect screen = ui.metrics.screen;
  const std::uint64_t around = ui.widgets.add("sheet/around", screen);
  ui.draw.fill(screen, colour::shade);
  const float w = std::min(ui.px(width), screen.width - ui.px(32));
  const float h = std::min(ui.px(height), screen.height - ui.px(32));
  const Rect r{std::round(screen.centre().x - w / 2), std::round(screen.centre().y - h / 2), w, h};
  ui.widgets.add("sheet", r);
  ui.draw.fill(r, colour::panel, ui.px(12));
  ui.draw.outline(r, colour::border, ui.px(1), ui.px(12));
  Rect inside = r.inset(ui.px(22), ui.px(16));
  Rect bar = inside.cut_top(std::max(ui.metrics.target, ui.px(48)));
  if (can_close) {
    const Rect corner = bar.cut_right(bar.height);
    ButtonLook look{Icon::close, Role::quiet, false, true, false};
    if (button(ui, "sheet/close", corner, "", look)) ui.send(close_sheet);
    for (const Gesture& g : ui.gestures) {
      if (g.kind == Gesture::Kind::tap && g.target == around) ui.send(close_sheet);
    }
  }
  ui.draw.text_in(bar, Align::left, Type::title, colour::ink, title);
  inside.cut_top(ui.px(8));
  return inside;
}

void progress_bar(Ui& ui, const Rect& r, double part) {
  const auto filled = static_cast<float>(std::clamp(part, 0.0, 1.0));
  ui.draw.fill(r, colour::raised, r.height / 2);
  ui.draw.fill({r.x, r.y, std::max(r.height, r.width * filled), r.height}, colour::accent, r.height / 2);
}

}  // namespace sonoband::ui
