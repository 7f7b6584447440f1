// What has been recorded, newest first. Nothing here saves: everything is saved as it happens.
#include <cmath>

#include "ui/controls.h"
#include "ui/panels/panels.h"

namespace sonoband::ui {
namespace {

constexpr std::array<std::string_view, 12> row_names = {"exams/0", "exams/1", "exams/2",  "exams/3",
                                                        "exams/4", "exams/5", "exams/6",  "exams/7",
                                                        "exams/8", "exams/9", "exams/10", "exams/11"};

std::string_view state_words(const ExamView& exam, const Texts& t) {
  if (exam.open) return t.is_open;
  switch (exam.state) {
    case ExamState::complete:
      return {};
    case ExamState::recording:
      return t.being_recorded;
    case ExamState::recovered:
      return t.recovered;
    case ExamState::damaged:
      return t.damaged;
    case ExamState::deleted:
      break;
  }
  return t.deleted;
}

Line detail_of(const ExamView& exam, const Texts& t) {
  if (exam.sweep > 0 && exam.sweeps > 1)
    return {t.exam_chosen_sweep,
            {exam.when, number(exam.sweep, 0), number(exam.sweeps, 0),
             count(static_cast<std::uint64_t>(exam.frames)), number(exam.seconds, 0)}};
  if (exam.sweeps == 1)
    return {t.exam_one_sweep,
            {exam.when, count(static_cast<std::uint64_t>(exam.frames)), number(exam.seconds, 0)}};
  return {t.exam_detail,
          {exam.when, number(exam.sweeps, 0), count(static_cast<std::uint64_t>(exam.frames)),
           number(exam.seconds, 0)}};
}

// Which sweep of an exam with several is meant: one back, one on.
void draw_sweep_choice(Ui& ui, Rect& inside, const ExamView& exam) {
  const float side = ui.metrics.target;
  ButtonLook on{Icon::forward, Role::plain, false, exam.sweep < exam.sweeps, false};
  if (button(ui, "exams/next-sweep", inside.cut_right(side), "", on)) ui.send(command::ChooseSweep{1});
  inside.cut_right(ui.px(8));
  ButtonLook back{Icon::back, Role::plain, false, exam.sweep > 1, false};
  if (button(ui, "exams/previous-sweep", inside.cut_right(side), "", back)) ui.send(command::ChooseSweep{-1});
  inside.cut_right(ui.px(12));
}

void draw_row(Ui& ui, const Rect& r, const View& view, const ExamView& exam, int place) {
  const Texts& t = ui.texts;
  const bool chosen = exam.id == view.exams.selected;
  const std::uint64_t id = ui.widgets.add(row_names[place], r);
  const bool held = ui.finger.down && ui.finger.target == id;
  ui.draw.fill(r, chosen ? colour::accent_ground : (held ? colour::raised : colour::panel), ui.px(8));
  if (chosen) ui.draw.outline(r, colour::accent, ui.px(1.5f), ui.px(8));
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    if (g.kind == Gesture::Kind::tap) ui.send(command::SelectExam{exam.id});
    if (g.kind == Gesture::Kind::double_tap) ui.send(command::OpenExam{exam.id});
  }
  Rect inside = r.inset(ui.px(10));
  const Rect picture = inside.cut_left(inside.height * 4 / 3);
  ui.draw.fill(picture, colour::picture, ui.px(4));
  const Slot slot = thumbnail(place);
  ui.pictures.show(slot, exam.picture);
  const float width = ui.draw.picture_width(slot);
  if (width > 0) ui.draw.picture(slot, fit(picture, width, ui.draw.picture_height(slot)), view.review.look);
  inside.cut_left(ui.px(16));
  if (chosen && exam.sweep > 0 && exam.sweeps > 1) draw_sweep_choice(ui, inside, exam);
  const std::string_view state = state_words(exam, t);
  if (!state.empty()) {
    const bool warns = exam.state == ExamState::recovered || exam.state == ExamState::damaged;
    const Colour c = warns ? colour::warning : colour::accent;
    ui.draw.text_in(inside.cut_right(ui.draw.width_of(Type::small, state) + ui.px(10)), Align::right,
                    Type::small, c, state);
  }
  const bool named = !exam.label.empty();
  const Rect upper = row(inside, 0, 2, 0);
  const Rect lower = row(inside, 1, 2, 0);
  ui.draw.text_in(upper, Align::left, Type::strong, named ? colour::ink : colour::ink_quiet,
                  named ? exam.label : t.no_label);
  if (exam.damage.empty()) {
    ui.draw.text_in(lower, Align::left, Type::small, colour::ink_quiet, detail_of(exam, t));
  } else {
    ui.draw.text_in(lower, Align::left, Type::small, colour::warning, exam.damage);
  }
}

}  // namespace

void draw_exams(Ui& ui, const Rect& r, const View& view) {
  const Texts& t = ui.texts;
  const ExamsView& exams = view.exams;
  const float gap = ui.px(8);
  const float line = std::max(ui.metrics.target, ui.px(54));
  Rect rest = r;
  Rect foot = rest.cut_bottom(line);
  rest.cut_bottom(gap);

  const float width = std::min(ui.px(150), (foot.width - 4 * gap) / 5.4f);
  const bool any = exams.selected != 0;
  ButtonLook fresh{Icon::plus, Role::primary, false, true, false};
  if (button(ui, "exams/new", foot.cut_left(width), t.new_exam, fresh))
    ui.send(command::OpenSheet{Sheet::new_exam, Source::scanner});
  foot.cut_left(gap);
  ButtonLook open{Icon::exams, Role::plain, false, any, false};
  if (button(ui, "exams/open", foot.cut_left(width), t.open, open))
    ui.send(command::OpenExam{exams.selected});
  foot.cut_left(gap);
  ButtonLook out{Icon::export_to, Role::plain, false, any && exams.on_disk, false};
  if (button(ui, "exams/export", foot.cut_left(width), t.export_exam, out))
    ui.send(command::OpenSheet{Sheet::export_exam, Source::scanner});
  ButtonLook bin{Icon::bin, Role::danger, false, any, false};
  if (button(ui, "exams/delete", foot.cut_right(width), t.remove, bin))
    ui.send(command::DeleteExam{exams.selected});
  foot.cut_right(gap);
  if (exams.can_undo_delete) {
    ButtonLook undo{Icon::undo, Role::plain, false, true, false};
    if (button(ui, "exams/undo", foot.cut_right(width * 1.25f), t.undo_delete, undo))
      ui.send(command::UndoDelete{});
    foot.cut_right(gap);
  }
  if (foot.width >
      ui.draw.width_of(Type::small, view.exams.on_disk ? t.saved_as_it_happens : t.kept_in_memory) +
          ui.px(12)) {
    ui.draw.text_in(foot, Align::centre, Type::small, colour::ink_quiet,
                    view.exams.on_disk ? t.saved_as_it_happens : t.kept_in_memory);
  }

  if (exams.exams.empty()) {
    ui.draw.fill(rest, colour::panel, ui.px(8));
    empty_note(ui, rest, Icon::exams, colour::ink_quiet, t.no_exams, t.no_exams_cure);
    return;
  }
  const float height = std::max(ui.px(84), ui.metrics.target);
  const int fits = std::min(static_cast<int>(row_names.size()),
                            std::max(1, static_cast<int>((rest.height + gap) / (height + gap))));
  const std::uint64_t list = ui.widgets.add("exams/list", rest);
  const int last_first = std::max(0, static_cast<int>(exams.exams.size()) - fits);
  const int first = std::clamp(exams.first, 0, last_first);
  for (int i = 0; i < fits && first + i < static_cast<int>(exams.exams.size()); ++i) {
    draw_row(ui, rest.cut_top(height), view, exams.exams[first + i], i);
    rest.cut_top(gap);
  }
  // A drag over the rows scrolls by whole rows.
  for (const Gesture& g : ui.gestures) {
    bool ours = g.target == list;
    for (const std::string_view name : row_names) ours = ours || g.target == id_of(name);
    if (!ours || g.kind != Gesture::Kind::drag || g.phase == Gesture::Phase::end) continue;
    const auto now = std::lround((g.start.y - g.at.y) / (height + gap));
    const auto before = std::lround((g.start.y - g.at.y + g.step.y) / (height + gap));
    if (now != before) ui.send(command::ScrollExams{static_cast<int>(now - before)});
  }
}

}  // namespace sonoband::ui
