#include <numbers>

#include "ui/controls.h"
#include "ui/panels/lamps.h"
#include "ui/panels/marks.h"
#include "ui/panels/panels.h"

namespace sonoband::ui {
namespace {

std::string_view name_of(Compounding c, const Texts& t) {
  switch (c) {
    case Compounding::maximum:
      return t.maximum;
    case Compounding::minimum:
      return t.minimum;
    case Compounding::mean:
      break;
  }
  return t.mean;
}

bool has_pictures(const StatusView& s) {
  return s.scanner.health == Health::good || s.scanner.health == Health::degraded;
}

bool can_record(const StatusView& s) {
  const bool poses = s.tracker.health == Health::good || s.tracker.health == Health::degraded;
  return has_pictures(s) && poses && s.storage.minutes_left >= 1 && s.storage.health != Health::fault;
}

// Under the picture: what the pedal is doing, and the button that stands in for it.
void draw_state(Ui& ui, Rect r, const View& view) {
  const LiveView& live = view.live;
  const Texts& t = ui.texts;
  const float side = std::max(ui.metrics.target, ui.px(54));
  const Rect place = r.cut_left(side);
  const Rect key{place.x, r.centre().y - side / 2, side, side};
  const std::uint64_t id = ui.widgets.add("live/record", key);
  const bool held = ui.finger.down && ui.finger.target == id;
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    if (g.kind == Gesture::Kind::press) ui.send(command::Pedal{true});
    if (g.kind == Gesture::Kind::release) ui.send(command::Pedal{false});
  }
  const float radius = side / 2 - ui.px(3);
  ui.draw.disc(key.centre(), radius, live.recording ? colour::alarm.with_alpha(0.28f) : colour::raised);
  ui.draw.ring(key.centre(), radius, live.recording ? colour::alarm : colour::ink_quiet, ui.px(2.5f));
  const float core = held ? 0.42f : 0.52f;
  if (live.recording) {
    const float half = radius * core * 0.8f;
    ui.draw.fill({key.centre().x - half, key.centre().y - half, 2 * half, 2 * half}, colour::alarm, ui.px(4));
  } else {
    ui.draw.disc(key.centre(), radius * core, colour::alarm);
  }
  r.cut_left(ui.px(14));
  if (live.recording) {
    const Line words(t.recording, {clock_time(seconds(live.recorded))});
    const Line left(t.frames_and_left,
                    {count(static_cast<std::uint64_t>(live.frames)), number(live.seconds_left, 0)});
    const float width = ui.draw.width_of(Type::large, words) + ui.px(8);
    ui.draw.text_in(r.cut_left(width), Align::left, Type::large, colour::ink, words);
    ui.draw.text_in(r.inset(ui.px(6), 0), Align::right, Type::body, colour::ink_quiet, left);
    return;
  }
  const bool ready = can_record(view.status);
  const std::string_view state = ready ? t.ready : t.not_ready;
  ui.draw.text_in(r.cut_left(ui.draw.width_of(Type::large, state) + ui.px(16)), Align::left, Type::large,
                  ready ? colour::ink : colour::ink_quiet, state);
  const Line room(t.room_for, {number(view.status.ring.seconds_free, 0)});
  if (ready) ui.draw.text_in(r.inset(ui.px(6), 0), Align::right, Type::body, colour::ink_quiet, room);
}

void draw_picture(Ui& ui, const Rect& r, const View& view) {
  const LiveView& live = view.live;
  const Texts& t = ui.texts;
  ui.draw.fill(r, colour::panel, ui.px(8));
  Rect inside = r.inset(ui.px(12));
  draw_state(ui, inside.cut_bottom(std::max(ui.metrics.target, ui.px(56))), view);
  inside.cut_bottom(ui.px(10));
  ui.widgets.add("live/picture", inside);
  ui.pictures.show(Slot::live, live.picture);
  const float width = ui.draw.picture_width(Slot::live);
  if (width <= 0) {
    const Fault fault = worst_fault(view, t);
    ui.draw.fill(inside, colour::picture, ui.px(4));
    empty_note(ui, inside, Icon::live, colour::ink_quiet, t.no_scanner,
               fault.title == t.no_scanner ? fault.cure.view() : t.no_scanner_cure);
    return;
  }
  const Rect place = fit(inside, width, ui.draw.picture_height(Slot::live));
  ui.draw.fill(place, colour::picture);
  ui.draw.picture(Slot::live, place, view.review.look);
  if (live.pose) {
    const double mm_per_px = live.pose->linear.col(1).norm();
    draw_depth_scale(ui, place,
                     static_cast<float>(place.height / (mm_per_px * ui.draw.picture_height(Slot::live))));
  }
  draw_orientation_mark(ui, place);
  const Vec2 badge{place.centre().x, place.y + ui.px(28)};
  if (!has_pictures(view.status)) {
    // The last picture there was must not pass for a live one.
    ui.draw.fill(place, colour::picture.with_alpha(0.65f));
    draw_badge(ui, badge, colour::alarm, t.no_scanner);
  } else if (view.status.scanner.frozen) {
    draw_badge(ui, badge, colour::warning, t.frozen);
  }
  if (live.first_time && !live.recording && can_record(view.status)) {
    const bool hold = view.status.pedal.mode == PedalMode::hold;
    const Rect strip{place.x, place.bottom() - ui.px(90), place.width, ui.px(90)};
    ui.draw.fill(strip, colour::ground.with_alpha(0.86f));
    Rect words = strip.inset(ui.px(16), ui.px(10));
    ui.draw.text_in(words.cut_bottom(ui.px(20)), Align::left, Type::small, colour::warning, t.research_only);
    ui.draw.paragraph(words, Type::body, colour::ink, hold ? t.first_time_hold : t.first_time_toggle);
  }
}

void draw_growing(Ui& ui, const Rect& r, const View& view) {
  const LiveView& live = view.live;
  const Texts& t = ui.texts;
  ui.pictures.show(Slot::growing, live.growing);
  const bool any = ui.draw.picture_width(Slot::growing) > 0;
  const Line detail(t.band_detail, {number(live.growing_mm, 1), name_of(live.compounding, t)});
  const Rect inside = panel(ui, r, t.band_so_far, any ? detail.view() : std::string_view());
  if (!any) {
    empty_note(ui, inside, Icon::record, colour::ink_quiet, t.no_band, t.no_band_cure);
    return;
  }
  ui.draw.fill(inside, colour::no_data, ui.px(4));
  const Rect place = fit(inside, ui.draw.picture_width(Slot::growing), ui.draw.picture_height(Slot::growing));
  ui.draw.picture(Slot::growing, place, view.review.look);
  ui.widgets.add("live/band", inside);
}

void draw_speed(Ui& ui, const Rect& r, const View& view) {
  const LiveView& live = view.live;
  const Texts& t = ui.texts;
  Rect inside = panel(ui, r, t.sweep_speed, "").inset(ui.px(6), 0);
  ui.widgets.add("live/speed", inside);
  // The mark is the speed at which neighbours are a beam width apart; the gauge ends at 4/3 of it.
  const double limit_mm_s = live.gap_mm > 0 ? live.speed_mm_s * live.widest_gap_mm / live.gap_mm : 0;
  const bool moving = live.gap_mm > 0 && live.widest_gap_mm > 0;
  const bool too_fast = moving && live.gap_mm > live.widest_gap_mm;
  const float line = ui.draw.height_of(Type::body) + ui.px(6);
  // In a narrow column speed and limit do not fit side by side.
  const Rect limit_words = inside.cut_bottom(line);
  const bool two_lines = inside.width < ui.px(380);
  const Rect words = two_lines ? inside.cut_bottom(line) : limit_words;
  const Align limit_side = two_lines ? Align::left : Align::right;
  const float height = std::min(ui.px(20), std::max(ui.px(8), inside.height - ui.px(8)));
  const Rect bar{inside.x, inside.centre().y - height / 2, inside.width, height};
  ui.draw.fill(bar, colour::raised, height / 2);
  if (moving) {
    const auto part = static_cast<float>(std::clamp(0.75 * live.gap_mm / live.widest_gap_mm, 0.02, 1.0));
    const Colour c =
        too_fast ? colour::alarm : (live.gap_mm > 0.85 * live.widest_gap_mm ? colour::warning : colour::good);
    ui.draw.fill({bar.x, bar.y, std::max(height, bar.width * part), height}, c, height / 2);
  }
  const float mark = bar.x + 0.75f * bar.width;
  ui.draw.line({mark, bar.y - ui.px(5)}, {mark, bar.bottom() + ui.px(5)}, colour::warning, ui.px(2.5f));
  if (!moving) {
    ui.draw.text_in(words, Align::left, Type::body, colour::ink_quiet, t.no_speed);
    return;
  }
  const Line now(t.speed_and_gap, {number(live.speed_mm_s, 1), number(live.gap_mm, 2)});
  if (too_fast) {
    ui.draw.text_in(limit_words, limit_side, Type::strong, colour::alarm, t.too_fast);
  } else {
    ui.draw.text_in(limit_words, limit_side, Type::small, colour::ink_quiet,
                    Line(t.too_fast_above, {number(limit_mm_s, 0)}));
  }
  ui.draw.text_in(words, Align::left, Type::body, colour::ink, now);
}

void draw_live_outline(Ui& ui, const Rect& r, const View& view) {
  const ReviewView& review = view.review;
  const Rect place = panel(ui, r, ui.texts.outline, "");
  SceneInput scene;
  scene.frames = review.frames;
  scene.frames_version = view.live.sweep_version;
  scene.orbit = review.orbit;
  if (view.live.pose && !view.live.picture.pixels.empty()) {
    scene.probe =
        corners_of(*view.live.pose, view.live.picture.pixels.width, view.live.picture.pixels.height);
  }
  if (review.frames.empty() && !scene.probe) {
    empty_note(ui, place, Icon::none, colour::ink_quiet, ui.texts.not_scanned, "");
    return;
  }
  const SceneTexture picture =
      ui.scene.render(scene, static_cast<int>(place.width), static_cast<int>(place.height), ui.px(1));
  ui.draw.scene(picture, place);
  orbit_by_gestures(ui, "live/outline", place, review.orbit);
}

// The B-scan is what the hand follows: it gets all the height there is and the width that goes with it; the
// column beside it makes do with the rest.
float column_width(const Ui& ui, const Rect& r, const LiveView& live) {
  const ConstPixels& p = live.picture.pixels;
  const float shape = p.empty() ? 4 / 3.0f : static_cast<float>(p.width) / static_cast<float>(p.height);
  const float height = r.height - std::max(ui.metrics.target, ui.px(56)) - ui.px(10 + 2 * 12);
  const float least = std::max(ui.px(250), 0.22f * r.width);
  return std::clamp(r.width - ui.px(8 + 2 * 12) - shape * height, least, std::max(least, 0.37f * r.width));
}

}  // namespace

void draw_live(Ui& ui, const Rect& r, const View& view) {
  Rect rest = r;
  const float gap = ui.px(8);
  Rect right = rest.cut_right(column_width(ui, r, view.live));
  rest.cut_right(gap);
  draw_picture(ui, rest, view);
  const Rect speed = right.cut_bottom(std::max(ui.px(130), r.height * 0.17f));
  right.cut_bottom(gap);
  const Rect band = right.cut_top(right.height * 0.57f);
  right.cut_top(gap);
  draw_growing(ui, band, view);
  draw_live_outline(ui, right, view);
  draw_speed(ui, speed, view);
}

}  // namespace sonoband::ui
