#include <array>

#include "ui/controls.h"
#include "ui/panels/lamps.h"
#include "ui/panels/panels.h"

namespace sonoband::ui {
namespace {

constexpr std::array<std::string_view, 8> probe_names = {"set-up/probe-0", "set-up/probe-1", "set-up/probe-2",
                                                         "set-up/probe-3", "set-up/probe-4", "set-up/probe-5",
                                                         "set-up/probe-6", "set-up/probe-7"};

void draw_probes(Ui& ui, const Rect& r, const SetUpView& s) {
  const Texts& t = ui.texts;
  Rect rest = panel(ui, r, t.probe, "");
  const float height = std::max(ui.metrics.target, ui.px(60));
  for (int i = 0;
       i < static_cast<int>(std::min(s.probes.size(), probe_names.size())) && rest.height >= height; ++i) {
    const ProbeView& p = s.probes[i];
    const Rect line = rest.cut_top(height);
    rest.cut_top(ui.px(6));
    const std::uint64_t id = ui.widgets.add(probe_names[i], line);
    const bool chosen = i == s.probe;
    const bool held = ui.finger.down && ui.finger.target == id;
    ui.draw.fill(line, chosen ? colour::accent_ground : (held ? colour::pressed : colour::raised), ui.px(8));
    if (chosen) ui.draw.outline(line, colour::accent, ui.px(1.5f), ui.px(8));
    for (const Gesture& g : ui.gestures) {
      if (g.kind == Gesture::Kind::tap && g.target == id) ui.send(command::ChooseProbe{i});
    }
    const Rect inside = line.inset(ui.px(14), ui.px(6));
    ui.draw.text_in(row(inside, 0, 2, 0), Align::left, Type::strong, colour::ink,
                    p.depth_mm > 0
                        ? Line(t.probe_line, {p.name.empty() ? t.unnamed : p.name, number(p.depth_mm, 0)})
                        : Line("{0}", {p.name.empty() ? t.unnamed : p.name}));
    const Line age = !p.calibrated            ? Line(t.not_calibrated, {})
                     : p.calibration_days < 0 ? Line(t.calibrated, {})
                     : p.calibration_days < 1 ? Line(t.calibrated_today, {})
                                              : Line(t.calibrated_days, {number(p.calibration_days, 0)});
    ui.draw.text_in(row(inside, 1, 2, 0), Align::left, Type::small,
                    p.calibrated ? colour::ink_quiet : colour::warning, age);
  }
}

void draw_devices(Ui& ui, const Rect& r, const StatusView& s) {
  const Texts& t = ui.texts;
  Rect rest = panel(ui, r, t.devices, "");
  ui.widgets.add("set-up/devices", r);
  struct Device {
    std::string_view name;
    Lamp lamp;
    std::string_view reason;
  };
  const Device all[] = {{t.scanner, scanner_lamp(s.scanner, t), s.scanner.reason},
                        {t.tracker, tracker_lamp(s.tracker, t), s.tracker.reason},
                        {t.pedal, pedal_lamp(s.pedal, t), s.pedal.reason},
                        {t.storage, storage_lamp(s.storage, t), s.storage.reason},
                        {t.touchscreen, touchscreen_lamp(s.touch, t), s.touch.reason}};
  const float height = ui.px(52);
  for (const Device& d : all) {
    if (&d == &all[4] && !s.touch.expected) continue;
    if (rest.height < height) break;
    Rect line = rest.cut_top(height);
    ui.draw.disc({line.x + ui.px(12), line.centre().y}, ui.px(7), d.lamp.colour);
    line.cut_left(ui.px(32));
    const Rect words = line.inset(0, ui.px(4));
    ui.draw.text_in(row(words, 0, 2, 0), Align::left, Type::body, colour::ink, d.name);
    ui.draw.text_in(row(words, 1, 2, 0), Align::left, Type::small, colour::ink_quiet,
                    d.reason.empty() ? d.lamp.words.view() : d.reason);
  }
}

// A title, two buttons and a sentence about the one chosen.
int draw_either(Ui& ui, const Rect& r, std::string_view title, std::initializer_list<Choice> both, int chosen,
                std::string_view words) {
  Rect rest = panel(ui, r, title, "");
  const int tapped = choices(ui, rest.cut_top(ui.metrics.target), both, chosen);
  rest.cut_top(ui.px(8));
  ui.draw.paragraph(rest, Type::small, colour::ink_quiet, words);
  return tapped;
}

}  // namespace

void draw_set_up(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const SetUpView& s = view.set_up;
  const float gap = ui.px(8);
  const float line = ui.px(26);
  const float title = ui.px(38);
  Rect left = column(r, 0, 2, gap);
  Rect right = column(r, 1, 2, gap);
  const auto lines = static_cast<float>(std::clamp<std::size_t>(s.probes.size(), 1, 4));
  draw_probes(
      ui, left.cut_top(title + lines * (std::max(ui.metrics.target, ui.px(60)) + ui.px(6)) + ui.px(8)), s);
  left.cut_top(gap);
  draw_devices(ui, left.cut_top(title + (view.status.touch.expected ? 5 : 4) * ui.px(52) + ui.px(12)),
               view.status);
  left.cut_top(gap);
  if (s.capture_width > 0 && left.height >= title + line + ui.px(16)) {
    const Rect inside = panel(ui, left.cut_top(title + line + ui.px(16)), t.crop, "");
    ui.draw.text_in(
        {inside.x + ui.px(4), inside.y, inside.width, line}, Align::left, Type::body, colour::ink,
        Line(t.crop_line, {number(s.crop_px.width, 0), number(s.crop_px.height, 0), number(s.crop_px.x, 0),
                           number(s.crop_px.y, 0), number(s.capture_width, 0), number(s.capture_height, 0)}));
  }

  const float either = title + ui.metrics.target + ui.px(46);
  const bool hold = s.pedal_mode == PedalMode::hold;
  const int mode = draw_either(ui, right.cut_top(either), t.pedal_mode,
                               {{"set-up/hold", t.hold_mode}, {"set-up/toggle", t.toggle_mode}}, hold ? 0 : 1,
                               hold ? t.hold_mode_words : t.toggle_mode_words);
  if (mode >= 0) ui.send(command::ChoosePedalMode{mode == 0 ? PedalMode::hold : PedalMode::toggle});
  right.cut_top(gap);
  if (s.has_sound) {
    const int sound =
        draw_either(ui, right.cut_top(either), t.sound,
                    {{"set-up/sound-on", t.on, Icon::sound}, {"set-up/sound-off", t.off, Icon::silent}},
                    s.sound ? 0 : 1, t.sound_words);
    if (sound >= 0) ui.send(command::SetSound{sound == 0});
    right.cut_top(gap);
  }

  if (s.sound_missing && !s.has_sound) {
    const Rect silent = right.cut_top(title + line + ui.px(16));
    const Rect words = panel(ui, silent, t.sound, "");
    ui.widgets.add("set-up/no-sound", silent);
    ui.draw.text_in({words.x + ui.px(4), words.y, words.width, line}, Align::left, Type::body,
                    colour::warning, t.no_sound);
    right.cut_top(gap);
  }

  const Rect storage = right.cut_top(std::min(right.height, title + line + ui.px(16)));
  const Rect place = panel(ui, storage, t.storage, "");
  ui.widgets.add("set-up/storage", storage);
  Rect words = {place.x + ui.px(4), place.y, place.width - ui.px(8), line};
  const Line left_over(t.disk_minutes, {number(view.status.storage.minutes_left, 0)});
  ui.draw.text_in(words.cut_right(ui.draw.width_of(Type::body, left_over) + ui.px(2)), Align::right,
                  Type::body, colour::ink_quiet, left_over);
  words.cut_right(ui.px(12));
  ui.draw.text_in(words, Align::left, Type::body, colour::ink, s.storage_place);
  right.cut_top(gap);
  if (right.height < ui.px(70)) return;
  Rect about = panel(ui, right.cut_top(title + 2 * line + ui.px(16)), t.about, "").inset(ui.px(4), 0);
  ui.draw.text_in(about.cut_top(line), Align::left, Type::body, colour::ink, Line(t.about_line, {s.version}));
  ui.draw.text_in(about.cut_top(line), Align::left, Type::body, colour::warning, t.research_only);
}

}  // namespace sonoband::ui
