// Export: what of an exam, as what, where to; how far it is; and taking the stick away safely.
#include <array>
#include <cmath>

#include "ui/controls.h"
#include "ui/panels/panels.h"
#include "ui/panels/sheet.h"

namespace sonoband::ui {
namespace {

constexpr std::array<std::string_view, 9> format_names = {"export/mha",  "export/nrrd",  "export/sx",
                                                          "export/sw",   "export/dicom", "export/png",
                                                          "export/webm", "export/turn",  "export/marks"};
constexpr std::array<std::string_view, 4> place_names = {"export/place-0", "export/place-1", "export/place-2",
                                                         "export/place-3"};
constexpr int rows = 5;
constexpr int most_places = 4;

const ExamView* selected_exam(const ExamsView& exams) {
  for (const ExamView& e : exams.exams)
    if (e.id == exams.selected) return &e;
  return nullptr;
}

void draw_formats(Ui& ui, Rect r, const ExportView& e) {
  const Texts& t = ui.texts;
  ui.draw.text_in(r.cut_top(ui.px(26)), Align::left, Type::small, colour::ink_quiet, t.format);
  for (int i = 0; i < static_cast<int>(format_names.size()); ++i) {
    const Rect cell = column(row(r, i % rows, rows, ui.px(5)), i / rows, 2, ui.px(5));
    ButtonLook look;
    look.chosen = i == static_cast<int>(e.choice.format);
    look.enabled = !e.running();
    ExportChoice choice = e.choice;
    choice.format = static_cast<ExportAs>(i);
    const auto k = static_cast<std::size_t>(i);
    if (button(ui, format_names[k], cell, t.formats[k], look)) ui.send(command::ChooseExport{choice});
  }
}

void draw_places(Ui& ui, Rect r, const ExportView& e) {
  const Texts& t = ui.texts;
  ui.draw.text_in(r.cut_top(ui.px(26)), Align::left, Type::small, colour::ink_quiet, t.place);
  if (e.places.empty()) {
    ui.draw.paragraph(r.inset(0, ui.px(10)), Type::body, colour::warning, t.no_place);
    return;
  }
  for (int i = 0; i < std::min(most_places, static_cast<int>(e.places.size())); ++i) {
    const auto k = static_cast<std::size_t>(i);
    ButtonLook look;
    look.icon = e.places[k].removable ? Icon::export_to : Icon::exams;
    look.chosen = i == e.choice.place;
    look.enabled = !e.running();
    ExportChoice choice = e.choice;
    choice.place = i;
    if (button(ui, place_names[k], row(r, i, rows, ui.px(5)), e.places[k].label, look))
      ui.send(command::ChooseExport{choice});
  }
}

// Which sweeps, and whether the patient's label goes along.
void draw_options(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const ExportView& e = view.exams.transfer;
  const ExamView* exam = selected_exam(view.exams);
  const Rect left = column(r, 0, 2, ui.px(16));
  const Rect right = column(r, 1, 2, ui.px(16));
  // Marks are of the exam.
  const bool choice_of_sweeps =
      exam != nullptr && exam->sweeps > 1 && exam->sweep > 0 && e.choice.format != ExportAs::marks;
  if (choice_of_sweeps) {
    const Line one(t.one_sweep, {number(exam->sweep, 0)});
    const Line all(t.all_sweeps, {number(exam->sweeps, 0)});
    const int tapped =
        choices(ui, left, {{"export/one-sweep", one.view()}, {"export/all-sweeps", all.view()}},
                e.choice.one_sweep ? 0 : 1, !e.running());
    ExportChoice choice = e.choice;
    choice.one_sweep = tapped == 0;
    if (tapped >= 0) ui.send(command::ChooseExport{choice});
  }
  const bool has_place = e.choice.format == ExportAs::dicom;
  ButtonLook look;
  look.icon = e.choice.with_label && has_place ? Icon::check : Icon::close;
  look.chosen = e.choice.with_label && has_place;
  look.enabled = has_place && !e.running();
  ExportChoice choice = e.choice;
  choice.with_label = !choice.with_label;
  if (button(ui, "export/label", right, look.chosen ? t.with_label : t.without_label, look))
    ui.send(command::ChooseExport{choice});
}

// At rest: what the choice means. Else how far it is, or what came of it.
void draw_state(Ui& ui, Rect r, const ExportView& e) {
  const Texts& t = ui.texts;
  const float line = ui.px(24);
  const auto say = [&](Colour c, const Line& words, std::string_view more) {
    ui.draw.text_in(r.cut_top(line), Align::left, Type::strong, c, words);
    ui.draw.paragraph(r, Type::small, colour::ink, more);
  };
  switch (e.phase) {
    case ExportPhase::idle: {
      const auto k = static_cast<std::size_t>(e.choice.format);
      ui.draw.text_in(r.cut_top(line), Align::left, Type::small, colour::ink_quiet, t.format_words[k]);
      const std::string_view label = e.choice.format != ExportAs::dicom ? t.label_stays
                                     : e.choice.with_label              ? t.label_goes
                                                                        : t.label_is_left_out;
      ui.draw.text_in(r.cut_top(line), Align::left, Type::small,
                      label == t.label_goes ? colour::warning : colour::ink_quiet, label);
      return;
    }
    case ExportPhase::exporting:
      ui.draw.text_in(r.cut_top(line), Align::left, Type::strong, colour::ink,
                      Line(t.exporting, {number(std::floor(e.done * 100), 0)}));
      return progress_bar(ui, r.cut_top(line).inset(0, ui.px(6)), e.done);
    case ExportPhase::writing_out:
      return say(colour::warning, Line(t.writing_out, {e.where}), {});
    case ExportPhase::removing:
      return say(colour::warning, Line(t.removing, {e.where}), {});
    case ExportPhase::done:
      return say(colour::good,
                 e.files == 1 ? Line(t.exported_one, {e.where})
                              : Line(t.exported, {count(static_cast<std::uint64_t>(e.files)), e.where}),
                 e.sentence);
    case ExportPhase::failed:
      return say(colour::alarm, Line(t.not_exported, {}), e.sentence);
    case ExportPhase::cancelled:
      return say(colour::warning, Line(t.export_cancelled, {}), e.sentence);
    case ExportPhase::removed:
      return say(colour::good, Line(t.can_be_pulled, {e.where}), {});
  }
}

}  // namespace

void draw_export_sheet(Ui& ui, const View& view) {
  const Texts& t = ui.texts;
  const ExportView& e = view.exams.transfer;
  Rect rest = sheet_paper(ui, 720, 640, t.export_exam, true);
  Rect foot = rest.cut_bottom(std::max(ui.metrics.target, ui.px(48)));
  rest.cut_bottom(ui.px(6));
  const Rect state = rest.cut_bottom(ui.px(66));
  rest.cut_bottom(ui.px(6));
  draw_options(ui, rest.cut_bottom(ui.metrics.target), view);
  rest.cut_bottom(ui.px(8));
  draw_formats(ui, column(rest, 0, 2, ui.px(16)), e);
  draw_places(ui, column(rest, 1, 2, ui.px(16)), e);
  draw_state(ui, state, e);

  const bool known = e.choice.place >= 0 && e.choice.place < static_cast<int>(e.places.size());
  const Rect action = foot.cut_right(ui.px(190));
  foot.cut_right(ui.px(8));
  if (e.running()) {
    // What is handed to the system cannot be called back.
    ButtonLook stop;
    stop.enabled = e.phase == ExportPhase::exporting;
    if (button(ui, "export/cancel", action, t.cancel, stop)) ui.send(command::CancelExport{});
  } else {
    ButtonLook go{Icon::export_to, Role::primary, false, view.exams.selected != 0 && known, false};
    if (button(ui, "export/start", action, t.export_exam, go))
      ui.send(command::StartExport{view.exams.selected});
    if (known && e.places[static_cast<std::size_t>(e.choice.place)].removable &&
        button(ui, "export/remove", foot.cut_right(ui.px(210)), t.remove_safely, {}))
      ui.send(command::RemoveSafely{e.choice.place});
  }
  ui.draw.text_in(foot, Align::left, Type::small, colour::ink_quiet, t.research_only);
}

}  // namespace sonoband::ui
