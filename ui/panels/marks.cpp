#include "ui/panels/marks.h"

#include <cmath>

#include "ui/line.h"

namespace sonoband::ui {
namespace {

// Legible on any picture.
void shadowed(Ui& ui, Vec2 at, Type type, Colour c, std::string_view words) {
  const float off = std::max(1.0f, ui.px(1));
  ui.draw.text({at.x + off, at.y + off}, type, colour::picture.with_alpha(0.85f), words);
  ui.draw.text({at.x - off, at.y + off}, type, colour::picture.with_alpha(0.6f), words);
  ui.draw.text(at, type, c, words);
}

}  // namespace

void draw_depth_scale(Ui& ui, const Rect& picture, float px_per_mm) {
  if (!(px_per_mm > 0)) return;
  const float least_apart = ui.px(26);
  int step_mm = 10;
  while (static_cast<float>(step_mm) * px_per_mm < least_apart && step_mm < 1000)
    step_mm *= step_mm == 10 ? 2 : 5;
  const float end = picture.height - ui.px(8);
  for (int mm = step_mm; static_cast<float>(mm) * px_per_mm < end; mm += step_mm) {
    const float y = picture.y + static_cast<float>(mm) * px_per_mm;
    ui.draw.line({picture.right() - ui.px(9), y}, {picture.right() - ui.px(1), y},
                 colour::picture.with_alpha(0.7f), ui.px(4));
    ui.draw.line({picture.right() - ui.px(8), y}, {picture.right() - ui.px(2), y}, colour::ink, ui.px(1.5f));
    const bool last = static_cast<float>(mm + step_mm) * px_per_mm >= end;
    const Line words(last ? ui.texts.millimetres : "{0}", {number(mm, 0)});
    const float width = ui.draw.width_of(Type::small, words);
    shadowed(ui, {picture.right() - ui.px(13) - width, y - ui.draw.height_of(Type::small) / 2}, Type::small,
             colour::ink, words);
  }
}

double scale_length_mm(double px_per_mm, double most_px) {
  double best = 0;
  for (double decade = 0.1; decade < 1000; decade *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit * decade * px_per_mm <= most_px) best = digit * decade;
    }
  }
  return best;
}

void draw_scale_bar(Ui& ui, const Rect& picture, double px_per_mm) {
  const double mm = scale_length_mm(px_per_mm, std::min<double>(ui.px(130), picture.width * 0.4));
  if (!(mm > 0)) return;
  const auto width = static_cast<float>(mm * px_per_mm);
  const float y = picture.bottom() - ui.px(12);
  const float x = picture.x + ui.px(12);
  ui.draw.line({x - 1, y}, {x + width + 1, y}, colour::picture.with_alpha(0.7f), ui.px(6));
  ui.draw.line({x, y}, {x + width, y}, colour::ink, ui.px(3));
  const Line words(ui.texts.millimetres, {number(mm, mm < 1 ? 1 : 0)});
  shadowed(ui, {x, y - ui.draw.height_of(Type::small) - ui.px(6)}, Type::small, colour::ink, words);
}

void draw_orientation_mark(Ui& ui, const Rect& picture) {
  const float s = ui.px(8);
  const Vec2 at{picture.right() - ui.px(14), picture.y + ui.px(14)};
  ui.draw.disc(at, s + ui.px(2), colour::picture.with_alpha(0.6f));
  ui.draw.disc(at, s * 0.75f, colour::accent);
}

void draw_orientation_arms(Ui& ui, const Rect& picture, Vec2 marked, Vec2 deep) {
  const float arm = std::min(ui.px(17), 0.08f * std::min(picture.width, picture.height));
  const float inset = arm + ui.px(11);
  const Vec2 from{picture.x + inset, picture.y + inset};
  const Vec2 away = from + arm * deep;
  const Vec2 side = from + arm * marked;
  ui.draw.disc(from, arm + ui.px(7), colour::picture.with_alpha(0.55f));
  ui.draw.line(from, away, colour::ink, ui.px(2));
  if (length(deep) > 0.3f) {
    const Vec2 along = (1 / length(deep)) * deep;
    const Vec2 across{-along.y, along.x};
    const float barb = ui.px(5);
    ui.draw.line(away, away - barb * (along + across), colour::ink, ui.px(2));
    ui.draw.line(away, away - barb * (along - across), colour::ink, ui.px(2));
  }
  ui.draw.line(from, side, colour::accent, ui.px(2));
  ui.draw.disc(side, ui.px(4.5f), colour::accent);
}

void draw_badge(Ui& ui, Vec2 centre, Colour c, std::string_view words) {
  const float width = ui.draw.width_of(Type::strong, words) + ui.px(28);
  const Rect r{centre.x - width / 2, centre.y - ui.px(15), width, ui.px(30)};
  ui.draw.fill(r, colour::ground.with_alpha(0.85f), ui.px(15));
  ui.draw.outline(r, c, ui.px(1.5f), ui.px(15));
  ui.draw.text_in(r, Align::centre, Type::strong, c, words);
}

void draw_point(Ui& ui, Vec2 at, Colour c, std::string_view label) {
  ui.draw.disc(at, ui.px(6.5f), colour::picture.with_alpha(0.7f));
  ui.draw.ring(at, ui.px(5), c, ui.px(2));
  if (!label.empty()) shadowed(ui, {at.x + ui.px(10), at.y - ui.px(16)}, Type::small, c, label);
}

void draw_tag(Ui& ui, Vec2 point, Colour c, std::string_view words) {
  const float height = ui.draw.height_of(Type::small) + ui.px(6);
  const Rect r{point.x + ui.px(12), point.y - height / 2, ui.draw.width_of(Type::small, words) + ui.px(14),
               height};
  ui.draw.fill(r, colour::ground.with_alpha(0.85f), height / 2);
  ui.draw.text_in(r, Align::centre, Type::small, c, words);
}

void orbit_by_gestures(Ui& ui, std::string_view name, const Rect& r, const Orbit& orbit) {
  const std::uint64_t id = ui.widgets.add(name, r);
  const double side = std::max(1.0f, std::min(r.width, r.height));
  Orbit now = orbit;
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    switch (g.kind) {
      case Gesture::Kind::drag:
        now = turned(now, g.step.x / side, g.step.y / side);
        break;
      case Gesture::Kind::pinch:
        now = zoomed(now, g.scale);
        break;
      case Gesture::Kind::two_finger_drag:
        now = slid(now, g.step.x / side, g.step.y / side);
        break;
      case Gesture::Kind::twist:
        now = turned(now, g.turn_rad / 3.14159265, 0);
        break;
      case Gesture::Kind::double_tap:
        now = Orbit{};
        break;
      default:
        break;
    }
  }
  if (!(now == orbit)) ui.send(command::SetOrbit{now});
}

}  // namespace sonoband::ui
