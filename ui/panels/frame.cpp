#include <span>

#include "ui/controls.h"
#include "ui/panels/lamps.h"
#include "ui/panels/panels.h"

namespace sonoband::ui {
namespace {

constexpr float recording_frame_units = 6;

// A strip across the page: what is wrong and what to do about it.
void draw_fault(Ui& ui, const Rect& r, const Fault& fault) {
  ui.draw.fill(r, colour::panel, ui.px(8));
  ui.draw.fill(r, fault.colour.with_alpha(0.16f), ui.px(8));
  Rect inside = r.inset(ui.px(14), 0);
  const Rect mark = inside.cut_left(ui.px(26));
  ui.draw.icon({mark.x + ui.px(9), mark.centre().y}, ui.px(18), fault.colour, Icon::warning);
  const float title = ui.draw.width_of(Type::strong, fault.title) + ui.px(2);
  ui.draw.text_in(inside.cut_left(title), Align::left, Type::strong, fault.colour, fault.title);
  inside.cut_left(ui.px(12));
  ui.draw.text_in(inside, Align::left, Type::body, colour::ink, fault.cure);
}

}  // namespace

void draw_status_bar(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const StatusView& s = view.status;
  ui.draw.fill(r, colour::ground);
  struct Entry {
    std::string_view name;
    std::string_view title;
    Lamp lamp;
    command::OpenSheet opens;
  };
  const Entry all_entries[] = {
      {"status/scanner", t.scanner, scanner_lamp(s.scanner, t), {Sheet::source, Source::scanner}},
      {"status/tracker", t.tracker, tracker_lamp(s.tracker, t), {Sheet::source, Source::tracker}},
      {"status/pedal", t.pedal, pedal_lamp(s.pedal, t), {Sheet::source, Source::pedal}},
      {"status/storage", t.storage, storage_lamp(s.storage, t), {Sheet::source, Source::storage}},
      {"status/ring", t.ring, ring_lamp(s.ring, t), {Sheet::source, Source::ring}},
      {"status/lost", t.lost, loss_lamp(s.losses, t), {Sheet::losses, Source::scanner}},
      {"status/stream", t.stream, stream_lamp(s.stream, t), {Sheet::none, Source::scanner}},
  };
  // Most carts send nothing.
  const auto entries = std::span(all_entries).first(s.stream.on ? 7 : 6);
  Rect rest = r.inset(ui.px(8), 0);
  const float claim = ui.draw.width_of(Type::small, t.research_only) + ui.px(16);
  // Wide lamps for the ones that say more; on a narrow screen all shrink alike and the claim goes.
  constexpr float units[] = {168, 172, 156, 112, 112, 132, 156};
  float all = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) all += ui.px(units[k]);
  if (rest.width >= all + claim) {
    ui.draw.text_in(rest.cut_right(claim).inset(ui.px(8), 0), Align::right, Type::small, colour::ink_quiet,
                    t.research_only);
  }
  const float squeeze = std::min(1.0f, rest.width / all);
  int i = 0;
  for (const Entry& e : entries) {
    Rect place = rest.cut_left(ui.px(units[i++]) * squeeze);
    const std::uint64_t id = ui.widgets.add(e.name, place);
    if (ui.finger.down && ui.finger.target == id)
      ui.draw.fill(place.inset(0, ui.px(4)), colour::raised, ui.px(8));
    for (const Gesture& g : ui.gestures) {
      if (g.kind == Gesture::Kind::tap && g.target == id && e.opens.sheet != Sheet::none) ui.send(e.opens);
    }
    ui.draw.disc({place.x + ui.px(15), place.centre().y}, ui.px(7), e.lamp.colour);
    place.cut_left(ui.px(30));
    const float line = ui.draw.height_of(Type::small) + ui.px(3);
    const float top = place.centre().y - line;
    ui.draw.text_in({place.x, top, place.width - ui.px(4), line}, Align::left, Type::small, colour::ink,
                    e.title);
    ui.draw.text_in({place.x, top + line, place.width - ui.px(4), line}, Align::left, Type::small,
                    colour::ink_quiet, e.lamp.words);
  }
}

void draw_rail(Ui& ui, const Rect& r, const View& view) {
  ui.draw.fill(r, colour::rail);
  const Texts& t = ui.texts;
  struct Entry {
    std::string_view name;
    std::string_view label;
    Icon icon;
    Page page;
  };
  const Entry entries[] = {
      {"rail/live", t.live, Icon::live, Page::live},
      {"rail/review", t.review, Icon::review, Page::review},
      {"rail/exams", t.exams, Icon::exams, Page::exams},
      {"rail/set-up", t.set_up, Icon::set_up, Page::set_up},
  };
  Rect rest = r.inset(ui.px(8), ui.px(10));
  const float side = std::min(std::max(ui.metrics.target, ui.px(72)), rest.height / 6 - ui.px(8));
  for (const Entry& e : entries) {
    ButtonLook look{e.icon, Role::quiet, view.page == e.page, true, true};
    if (button(ui, e.name, rest.cut_top(side), e.label, look)) ui.send(command::GoTo{e.page});
    rest.cut_top(ui.px(8));
  }
  ButtonLook help{Icon::help, Role::quiet, false, true, true};
  if (button(ui, "rail/help", rest.cut_bottom(side), t.help, help))
    ui.send(command::OpenSheet{Sheet::help, Source::scanner});
  rest.cut_bottom(ui.px(8));
  ButtonLook camera{Icon::snapshot, Role::quiet, false, true, true};
  if (button(ui, "rail/snapshot", rest.cut_bottom(side), t.snapshot, camera)) {
    ui.send(command::Snapshot{view.page == Page::review ? view.review.full : Window::none});
  }
}

void draw_screen(Ui& ui, const View& view) {
  Rect rest = ui.metrics.screen;
  ui.draw.fill(rest, colour::ground);
  draw_status_bar(ui, rest.cut_top(std::max(ui.px(48), ui.metrics.target)), view);
  draw_rail(ui, rest.cut_left(std::max(ui.px(88), ui.metrics.target)), view);
  Rect page = rest.inset(ui.px(10));
  if (!view.notice.empty()) {
    const Rect strip = page.cut_bottom(ui.px(40));
    page.cut_bottom(ui.px(8));
    ui.draw.fill(strip, colour::accent_ground, ui.px(8));
    ui.draw.text_in(strip.inset(ui.px(14), 0), Align::left, Type::body, colour::ink, view.notice);
  }
  const Fault fault = worst_fault(view, ui.texts);
  if (!fault.title.empty()) {
    draw_fault(ui, page.cut_top(ui.px(44)), fault);
    page.cut_top(ui.px(8));
  }
  switch (view.page) {
    case Page::live:
      draw_live(ui, page, view);
      break;
    case Page::review:
      draw_review(ui, page, view);
      break;
    case Page::exams:
      draw_exams(ui, page, view);
      break;
    case Page::set_up:
      draw_set_up(ui, page, view);
      break;
  }
  if (view.live.recording) ui.draw.outline(ui.metrics.screen, colour::alarm, ui.px(recording_frame_units));
  if (view.sheet != Sheet::none) draw_sheet(ui, view);
}

}  // namespace sonoband::ui
