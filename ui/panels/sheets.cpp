// Sheets that lie over a page until they are answered: each swallows every touch outside itself.
#include <array>
#include <cmath>

#include "ui/controls.h"
#include "ui/panels/lamps.h"
#include "ui/panels/panels.h"
#include "ui/panels/sheet.h"

namespace sonoband::ui {
namespace {

void draw_losses(Ui& ui, const View& view) {
  const LossStatus& losses = view.status.losses;
  const Texts& t = ui.texts;
  const float line = 34;
  const auto lines = static_cast<float>(std::max<std::size_t>(1, losses.by_cause.size()));
  Rect rest = sheet_paper(ui, 560, 110 + (lines + 1) * line, t.losses_title, true);
  if (losses.by_cause.empty()) {
    ui.draw.text_in(rest.cut_top(ui.px(line)), Align::left, Type::body, colour::ink_quiet, t.no_losses);
    return;
  }
  for (const LossLine& l : losses.by_cause) {
    Rect r = rest.cut_top(ui.px(line));
    ui.draw.text_in(r.cut_right(ui.px(110)), Align::right, Type::strong,
                    l.count > 0 ? colour::warning : colour::ink_quiet, count(l.count).view());
    ui.draw.text_in(r, Align::left, Type::body, colour::ink, l.cause);
  }
}

void draw_source(Ui& ui, const View& view) {
  const Texts& t = ui.texts;
  const StatusView& s = view.status;
  std::string_view title = t.scanner;
  std::string_view reason = s.scanner.reason;
  Lamp lamp = scanner_lamp(s.scanner, t);
  switch (view.sheet_source) {
    case Source::scanner:
      break;
    case Source::tracker:
      title = t.tracker;
      reason = s.tracker.reason;
      lamp = tracker_lamp(s.tracker, t);
      break;
    case Source::pedal:
      title = t.pedal;
      reason = s.pedal.reason;
      lamp = pedal_lamp(s.pedal, t);
      break;
    case Source::storage:
      title = t.storage;
      reason = s.storage.reason;
      lamp = storage_lamp(s.storage, t);
      break;
    case Source::ring:
      title = t.ring;
      reason = {};
      lamp = ring_lamp(s.ring, t);
      break;
  }
  Rect rest = sheet_paper(ui, 560, 210, title, true);
  Rect line = rest.cut_top(ui.px(34));
  ui.draw.disc({line.x + ui.px(9), line.centre().y}, ui.px(8), lamp.colour);
  line.cut_left(ui.px(30));
  ui.draw.text_in(line, Align::left, Type::strong, colour::ink, lamp.words);
  rest.cut_top(ui.px(6));
  ui.draw.paragraph(rest, Type::body, colour::ink_quiet, reason);
}

void draw_picture_sheet(Ui& ui, const View& view) {
  const Texts& t = ui.texts;
  const bool doppler = view.review.has_doppler;
  Look look = view.review.look;
  const float line = std::max(ui.metrics.target, ui.px(54)) / ui.metrics.unit;
  const float lines = doppler ? 5 : 3;
  Rect rest = sheet_paper(ui, 620, 96 + lines * (line + 8) + line + 12, t.picture_settings, true);
  const auto sliding = [&](std::string_view name, std::string_view title, const Line& value, double now,
                           double least, double most) {
    Rect r = rest.cut_top(ui.px(line));
    rest.cut_top(ui.px(8));
    ui.draw.text_in(r.cut_left(ui.px(150)), Align::left, Type::body, colour::ink, title);
    ui.draw.text_in(r.cut_right(ui.px(84)), Align::right, Type::strong, colour::ink, value);
    return slider(ui, name, r, now, least, most);
  };
  const auto switching = [&](std::string_view on, std::string_view off, std::string_view title, bool now) {
    Rect r = rest.cut_top(ui.px(line));
    rest.cut_top(ui.px(8));
    ui.draw.text_in(r.cut_left(ui.px(150)), Align::left, Type::body, colour::ink, title);
    const int tapped = choices(ui, r.cut_right(ui.px(220)), {{on, t.on}, {off, t.off}}, now ? 0 : 1);
    return tapped < 0 ? now : tapped == 0;
  };
  look.gain =
      static_cast<float>(sliding("picture/gain", t.gain, Line(t.signed_percent, {number(look.gain * 100, 0)}),
                                 look.gain, -0.5, 0.5)
                             .value);
  look.contrast =
      static_cast<float>(sliding("picture/contrast", t.contrast,
                                 Line(t.percent, {number(look.contrast * 100, 0)}), look.contrast, 0.5, 2.5)
                             .value);
  look.smooth = switching("picture/smooth-on", "picture/smooth-off", t.smooth_pixels, look.smooth);
  if (doppler) {
    look.colour = switching("picture/colour-on", "picture/colour-off", t.colour_flow, look.colour);
    const double level = sliding("picture/least-level", t.hide_slow,
                                 Line(t.of_levels, {number(look.least_level, 0)}), look.least_level, 0, 63)
                             .value;
    look.least_level = static_cast<int>(std::lround(level));
  }
  ButtonLook usual;
  if (button(ui, "picture/usual", rest.cut_top(ui.px(line)).cut_right(ui.px(220)), t.usual, usual))
    look = Look{};
  if (!(look == view.review.look)) ui.send(command::SetLook{look});
}

void draw_help(Ui& ui, const Texts& t) {
  Rect rest = sheet_paper(ui, 780, 560, t.help_title, true);
  const float line = std::min(ui.px(27), rest.height / static_cast<float>(t.help_lines.size()));
  for (const auto& [keys, words] : t.help_lines) {
    Rect r = rest.cut_top(line);
    ui.draw.text_in(r.cut_left(ui.px(220)), Align::left, Type::strong, colour::accent, keys);
    ui.draw.text_in(r, Align::left, Type::body, colour::ink, words);
  }
}

// Letters big enough for gloves; a label needs no more.
void draw_keyboard(Ui& ui, const Rect& r) {
  constexpr std::array<std::string_view, 4> rows = {"1234567890", "QWERTYUIOP", "ASDFGHJKL-", "ZXCVBNM.,/"};
  const float gap = ui.px(5);
  for (int i = 0; i < 5; ++i) {
    const Rect line = row(r, i, 5, gap);
    if (i == 4) {
      Rect wide = line;
      ButtonLook back;
      back.icon = Icon::backspace;
      if (button(ui, "key/backspace", wide.cut_right(line.width * 0.22f), "", back))
        ui.send(command::TypeLabel{8});
      wide.cut_right(gap);
      if (button(ui, "key/space", wide, "", {})) ui.send(command::TypeLabel{U' '});
      break;
    }
    for (int k = 0; k < static_cast<int>(rows[i].size()); ++k) {
      const std::string_view letter = rows[i].substr(k, 1);
      std::array<char, 6> name = {'k', 'e', 'y', '/', letter[0], 0};
      if (button(ui, {name.data(), 5}, column(line, k, static_cast<int>(rows[i].size()), gap), letter, {})) {
        ui.send(command::TypeLabel{static_cast<char32_t>(letter[0])});
      }
    }
  }
}

void draw_new_exam(Ui& ui, const View& view) {
  const Texts& t = ui.texts;
  Rect rest = sheet_paper(ui, 760, 560, t.new_exam, true);
  ui.draw.text_in(rest.cut_top(ui.px(24)), Align::left, Type::small, colour::ink_quiet, t.patient_label);
  const Rect field = rest.cut_top(std::max(ui.metrics.target, ui.px(52)));
  ui.draw.fill(field, colour::ground, ui.px(8));
  ui.draw.outline(field, colour::accent, ui.px(1.5f), ui.px(8));
  const Rect inside = field.inset(ui.px(14), 0);
  ui.draw.text_in(inside, Align::left, Type::title, colour::ink, view.exams.new_label);
  const float typed = std::min(inside.width, ui.draw.width_of(Type::title, view.exams.new_label));
  ui.draw.line({inside.x + typed + ui.px(2), field.y + ui.px(12)},
               {inside.x + typed + ui.px(2), field.bottom() - ui.px(12)}, colour::accent, ui.px(2));
  rest.cut_top(ui.px(12));
  const Rect foot = rest.cut_bottom(std::max(ui.metrics.target, ui.px(54)));
  rest.cut_bottom(ui.px(12));
  draw_keyboard(ui, rest);
  if (button(ui, "new-exam/cancel", column(foot, 0, 2, ui.px(8)), t.cancel, {})) ui.send(close_sheet);
  ButtonLook go{Icon::check, Role::primary, false, true, false};
  if (button(ui, "new-exam/start", column(foot, 1, 2, ui.px(8)), t.start_exam, go))
    ui.send(command::NewExam{});
}

void draw_recovering(Ui& ui, const View& view) {
  const Texts& t = ui.texts;
  Rect rest = sheet_paper(ui, 620, 220, t.recovering_title, false);
  ui.draw.paragraph(rest.cut_top(ui.px(60)), Type::body, colour::ink_quiet, t.recovering_words);
  progress_bar(ui, rest.cut_top(ui.px(12)), view.recovering);
}

}  // namespace

void draw_sheet(Ui& ui, const View& view) {
  switch (view.sheet) {
    case Sheet::none:
      return;
    case Sheet::losses:
      return draw_losses(ui, view);
    case Sheet::source:
      return draw_source(ui, view);
    case Sheet::picture:
      return draw_picture_sheet(ui, view);
    case Sheet::help:
      return draw_help(ui, ui.texts);
    case Sheet::new_exam:
      return draw_new_exam(ui, view);
    case Sheet::export_exam:
      return draw_export_sheet(ui, view);
    case Sheet::recovering:
      return draw_recovering(ui, view);
  }
}

}  // namespace sonoband::ui
