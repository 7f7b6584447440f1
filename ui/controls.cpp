#include "ui/controls.h"

namespace sonoband::ui {
namespace {

struct Pressing {
  bool held = false;    // a finger that landed on it is still on it
  bool tapped = false;  // and has just left it
};

Pressing pressing(Ui& ui, std::uint64_t id, const Rect& r, bool enabled) {
  Pressing p;
  if (!enabled) return p;
  p.held = ui.finger.down && ui.finger.target == id && r.contains(ui.finger.at);
  for (const Gesture& g : ui.gestures) {
    if (g.kind == Gesture::Kind::release && g.target == id && r.contains(g.at)) p.tapped = true;
  }
  return p;
}

}  // namespace

bool button(Ui& ui, std::string_view name, const Rect& r, std::string_view label, const ButtonLook& look) {
  const std::uint64_t id = ui.widgets.add(name, r, look.enabled);
  const Pressing press = pressing(ui, id, r, look.enabled);

  Colour ground = look.role == Role::quiet ? colour::raised.with_alpha(0) : colour::raised;
  Colour ink = colour::ink;
  if (look.role == Role::primary) {
    ground = colour::accent;
    ink = colour::ink_on_accent;
  }
  if (look.role == Role::danger) ink = colour::alarm;
  if (look.chosen) {
    ground = look.role == Role::quiet ? colour::accent_ground : colour::accent;
    ink = look.role == Role::quiet ? colour::accent : colour::ink_on_accent;
  } else if (look.role == Role::quiet) {
    ink = colour::ink_quiet;
  }
  if (press.held && !look.chosen && look.role != Role::primary) ground = colour::pressed;
  if (!look.enabled) {
    ink = colour::ink_quiet.with_alpha(0.45f);
    ground = ground.with_alpha(look.role == Role::quiet ? 0 : 0.5f);
  }
  const float radius = ui.px(8);
  if ((ground.rgba & 255) != 0) ui.draw.fill(r, ground, radius);
  if (press.held && (look.chosen || look.role == Role::primary))
    ui.draw.fill(r, colour::ink.with_alpha(0.25f), radius);
  if (look.role == Role::danger && look.enabled)
    ui.draw.outline(r, colour::alarm.with_alpha(0.6f), ui.px(1), radius);

  const float icon_size = ui.px(look.stacked ? 22 : 18);
  if (look.icon == Icon::none) {
    ui.draw.text_in(r.inset(ui.px(6), 0), Align::centre, Type::strong, ink, label);
  } else if (label.empty()) {
    ui.draw.icon(r.centre(), icon_size, ink, look.icon);
  } else if (look.stacked) {
    const float text_height = ui.draw.height_of(Type::small);
    const float all = icon_size + ui.px(7) + text_height;
    const float top = r.y + (r.height - all) / 2;
    ui.draw.icon({r.centre().x, top + icon_size / 2}, icon_size, ink, look.icon);
    ui.draw.text_in({r.x, top + icon_size + ui.px(7), r.width, text_height}, Align::centre, Type::small, ink,
                    label);
  } else {
    const float gap = ui.px(9);
    const float room = r.width - icon_size - gap - ui.px(16);
    const float width = std::min(room, ui.draw.width_of(Type::strong, label));
    const float x = r.x + (r.width - icon_size - gap - width) / 2;
    ui.draw.icon({x + icon_size / 2, r.centre().y}, icon_size, ink, look.icon);
    ui.draw.text_in({x + icon_size + gap, r.y, width + 1, r.height}, Align::left, Type::strong, ink, label);
  }
  return press.tapped;
}

int choices(Ui& ui, const Rect& r, std::initializer_list<Choice> all, int chosen, bool enabled) {
  int tapped = -1;
  ui.draw.fill(r, colour::raised, ui.px(8));
  int i = 0;
  for (const Choice& c : all) {
    ButtonLook look;
    look.icon = c.icon;
    look.chosen = i == chosen;
    look.enabled = enabled;
    if (button(ui, c.name, column(r, i, static_cast<int>(all.size()), 0), c.label, look)) tapped = i;
    ++i;
  }
  return tapped;
}

Slide slider(Ui& ui, std::string_view name, const Rect& r, double value, double least, double greatest,
             bool vertical, bool enabled) {
  const std::uint64_t id = ui.widgets.add(name, r, enabled);
  const float knob = ui.px(14);
  const float groove = ui.px(6);
  const float begin = (vertical ? r.y : r.x) + knob;
  const float span = std::max(1.0f, (vertical ? r.height : r.width) - 2 * knob);
  Slide slide;
  slide.value = value;
  const auto value_at = [&](Vec2 p) {
    const double part = std::clamp(((vertical ? p.y : p.x) - begin) / span, 0.0f, 1.0f);
    return least + part * (greatest - least);
  };
  const bool held = enabled && ui.finger.down && ui.finger.target == id;
  for (const Gesture& g : ui.gestures) {
    if (!enabled || g.target != id) continue;
    if (g.kind == Gesture::Kind::press || g.kind == Gesture::Kind::drag || g.kind == Gesture::Kind::release) {
      slide.changed = true;
      slide.value = value_at(g.at);
    }
    if (g.kind == Gesture::Kind::release) slide.done = true;
  }
  const double range = greatest - least;
  const float part = range > 0 ? static_cast<float>(std::clamp((slide.value - least) / range, 0.0, 1.0)) : 0;
  const Colour c = enabled ? colour::accent : colour::border;
  const Vec2 at =
      vertical ? Vec2{r.centre().x, begin + part * span} : Vec2{begin + part * span, r.centre().y};
  if (vertical) {
    ui.draw.fill({r.centre().x - groove / 2, begin, groove, span}, colour::raised, groove / 2);
  } else {
    ui.draw.fill({begin, r.centre().y - groove / 2, span, groove}, colour::raised, groove / 2);
    ui.draw.fill({begin, r.centre().y - groove / 2, part * span, groove}, c.with_alpha(0.6f), groove / 2);
  }
  if (held) ui.draw.disc(at, knob * 1.5f, c.with_alpha(0.25f));
  ui.draw.disc(at, knob, c);
  return slide;
}

Rect panel(Ui& ui, const Rect& r, std::string_view title, std::string_view detail, Icon corner) {
  ui.draw.fill(r, colour::panel, ui.px(8));
  Rect inside = r;
  Rect words = inside.cut_top(ui.px(38)).inset(ui.px(14), 0);
  if (corner != Icon::none) {
    const Rect place = words.cut_right(ui.px(18));
    ui.draw.icon(place.centre(), ui.px(14), colour::ink_quiet, corner);
    words.cut_right(ui.px(10));
  }
  const float title_width = std::min(words.width, ui.draw.width_of(Type::strong, title) + ui.px(2));
  ui.draw.text_in(words.cut_left(title_width), Align::left, Type::strong, colour::ink, title);
  words.cut_left(ui.px(12));
  ui.draw.text_in(words, Align::right, Type::small, colour::ink_quiet, detail);
  return {r.x + ui.px(10), inside.y, r.width - ui.px(20), inside.height - ui.px(10)};
}

void empty_note(Ui& ui, const Rect& r, Icon icon, Colour c, std::string_view title, std::string_view cure) {
  const float width = std::min(r.width - ui.px(24), ui.px(440));
  const float x = r.centre().x - width / 2;
  float y = r.centre().y - ui.px(56);
  ui.draw.icon({r.centre().x, y}, ui.px(34), c, icon);
  y += ui.px(30);
  ui.draw.text_in({x, y, width, ui.px(28)}, Align::centre, Type::title, colour::ink, title);
  y += ui.px(36);
  const float cure_width = ui.draw.width_of(Type::body, cure);
  if (cure_width <= width) {
    ui.draw.text_in({x, y, width, ui.px(22)}, Align::centre, Type::body, colour::ink_quiet, cure);
  } else {
    ui.draw.paragraph({x, y, width, ui.px(80)}, Type::body, colour::ink_quiet, cure);
  }
}

}  // namespace sonoband::ui
