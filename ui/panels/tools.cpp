// Under the four windows: how the bands are made (first row), and the tools with what each needs (second
// row).
#include <algorithm>
#include <cmath>

#include "ui/controls.h"
#include "ui/panels/contours.h"
#include "ui/panels/panels.h"
#include "ui/panels/windows.h"

namespace sonoband::ui {
namespace {

constexpr double thickest_mm = 20;

double rounded_thickness(double mm) {
  const double tenths = std::round(mm * 5) / 5;  // steps of a B-scan pixel
  return tenths < 0.3 ? 0 : tenths;
}

void draw_rendering(Ui& ui, Rect r, const View& view) {
  const Texts& t = ui.texts;
  const RenderSettings& s = view.review.settings;
  const float gap = ui.px(8);
  const bool any = !view.review.frames.empty();
  const float third = std::min(ui.px(104), r.width * 0.105f);
  const int compounding = choices(ui, r.cut_left(3 * third),
                                  {{"tools/maximum", t.maximum_button},
                                   {"tools/minimum", t.minimum_button},
                                   {"tools/mean", t.mean_button}},
                                  static_cast<int>(s.compounding), any);
  if (compounding >= 0) ui.send(command::ChooseCompounding{static_cast<Compounding>(compounding)});
  r.cut_left(gap);
  const int interpolation =
      choices(ui, r.cut_left(2 * third), {{"tools/nearest", t.nearest}, {"tools/linear", t.linear}},
              static_cast<int>(s.interpolation), any);
  if (interpolation >= 0) ui.send(command::ChooseInterpolation{static_cast<Interpolation>(interpolation)});
  r.cut_left(gap);

  ButtonLook look;
  look.icon = Icon::adjust;
  look.enabled = any;
  if (button(ui, "tools/picture", r.cut_right(std::max(ui.px(120), ui.metrics.target)), t.picture, look)) {
    ui.send(command::OpenSheet{Sheet::picture, Source::scanner});
  }
  r.cut_right(gap);
  ui.draw.fill(r, colour::panel, ui.px(8));
  Rect inside = r.inset(ui.px(12), 0);
  const float label = ui.draw.width_of(Type::body, t.thickness) + ui.px(4);
  if (inside.width > label + ui.px(230)) {
    ui.draw.text_in(inside.cut_left(label), Align::left, Type::body, colour::ink_quiet, t.thickness);
  }
  const double mm = s.band.thickness_mm;
  const Line words = mm > 0 ? Line(t.millimetres, {number(mm, 1)}) : Line(t.thin, {});
  ui.draw.text_in(inside.cut_right(ui.px(72)), Align::right, Type::strong,
                  any ? colour::ink : colour::ink_quiet, words);
  const Slide slide = slider(ui, "tools/thickness", inside, mm, 0, thickest_mm, false, any);
  if (slide.changed) ui.send(command::SetThickness{rounded_thickness(slide.value)});
  if (any) tell_pushing(ui, id_of("tools/thickness"));
}

struct Action {
  std::string_view name;
  std::string_view label;
  Icon icon;
  bool enabled;
};

bool action(Ui& ui, Rect& r, const Action& a) {
  const float width = ui.draw.width_of(Type::strong, a.label) + ui.px(58);
  ButtonLook look;
  look.icon = a.icon;
  look.enabled = a.enabled;
  const bool tapped = button(ui, a.name, r.cut_right(std::min(width, r.width)), a.label, look);
  r.cut_right(ui.px(6));
  return tapped;
}

void draw_context(Ui& ui, Rect r, const View& view) {
  const Texts& t = ui.texts;
  const ReviewView& review = view.review;
  std::string_view hint = t.hint_move;
  switch (review.tool) {
    case Tool::move:
      if (view.exams.on_disk &&
          action(ui, r, {"tools/export", t.export_exam, Icon::export_to, !review.frames.empty()}))
        ui.send(command::OpenSheet{Sheet::export_exam, Source::scanner});
      if (action(ui, r, {"tools/reset", t.reset, Icon::home, !review.frames.empty()}))
        ui.send(command::ResetPlane{});
      break;
    case Tool::curve:
      hint = t.hint_curve;
      if (action(ui, r, {"curve/clear", t.clear, Icon::clear, !review.curve.line.empty()}))
        ui.send(command::ClearCurve{});
      if (action(ui, r, {"curve/redo", t.redo, Icon::redo, review.curve.can_redo}))
        ui.send(command::RedoCurve{});
      if (action(ui, r, {"curve/undo", t.undo, Icon::undo, review.curve.can_undo}))
        ui.send(command::UndoCurve{});
      break;
    case Tool::landmark:
      hint = t.hint_landmark;
      break;
    case Tool::measure: {
      hint = t.hint_measure;
      if (action(ui, r, {"measure/clear", t.clear, Icon::clear, !review.measures.empty()}))
        ui.send(command::ClearMeasures{});
      const bool open =
          !review.measures.empty() && !review.measures.back().finished && review.measure == Measure::area;
      if (open && action(ui, r, {"measure/done", t.done, Icon::check, true}))
        ui.send(command::FinishMeasure{});
      const float width = std::min(ui.px(264), r.width);
      const int kind =
          choices(ui, r.cut_right(width),
                  {{"measure/distance", t.distance}, {"measure/angle", t.angle}, {"measure/area", t.area}},
                  static_cast<int>(review.measure), review.calibrated);
      if (kind >= 0) ui.send(command::ChooseMeasure{static_cast<Measure>(kind)});
      r.cut_right(ui.px(8));
      break;
    }
    case Tool::contour: {
      // What lies elsewhere is not cleared unseen.
      const auto seen = [&](const ContourView& c) { return in_sight(c, review); };
      hint = t.hint_contour;
      if (action(ui, r,
                 {"contour/clear", t.clear, Icon::clear,
                  std::any_of(review.contours.begin(), review.contours.end(), seen)})) {
        for (const ContourView& c : review.contours)
          if (seen(c)) ui.send(command::RemoveContour{c.number});
      }
      break;
    }
  }
  const bool measures =
      review.tool == Tool::landmark || review.tool == Tool::measure || review.tool == Tool::contour;
  const bool blocked = measures && !review.calibrated;
  const Rect words = r.inset(ui.px(10), 0);
  const float width = ui.draw.width_of(Type::small, blocked ? t.hint_uncalibrated : hint);
  const std::string_view say = blocked ? t.hint_uncalibrated : hint;
  const Colour ink = blocked ? colour::warning : colour::ink_quiet;
  if (width <= words.width) {
    ui.draw.text_in(words, Align::left, Type::small, ink, say);
  } else {
    const float lines = std::ceil(width / std::max(1.0f, words.width));
    const float height = lines * ui.draw.height_of(Type::small);
    if (words.width > ui.px(120) && height <= words.height) {
      ui.draw.paragraph({words.x, words.centre().y - height / 2, words.width, height}, Type::small, ink, say);
    }
  }
}

}  // namespace

void draw_tools(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const float gap = ui.px(8);
  draw_rendering(ui, row(r, 0, 2, gap), view);
  Rect second = row(r, 1, 2, gap);
  const float width = std::min(ui.px(560), second.width * 0.56f);
  // On a narrow screen five words with symbols do not fit side by side; the words stay.
  const bool symbols = width / 5 > ui.px(100);
  const auto icon = [&](Icon i) { return symbols ? i : Icon::none; };
  const int tool = choices(ui, second.cut_left(width),
                           {{"tools/move", t.tool_move, icon(Icon::move)},
                            {"tools/curve", t.tool_curve, icon(Icon::curve)},
                            {"tools/mark", t.tool_landmark, icon(Icon::landmark)},
                            {"tools/measure", t.tool_measure, icon(Icon::measure)},
                            {"tools/contour", t.tool_contour, icon(Icon::contour)}},
                           static_cast<int>(view.review.tool), !view.review.frames.empty());
  if (tool >= 0) ui.send(command::ChooseTool{static_cast<Tool>(tool)});
  draw_context(ui, second, view);
}

}  // namespace sonoband::ui
