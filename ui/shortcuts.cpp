#include "ui/shortcuts.h"

namespace sonoband::ui {
namespace {

void typed(Ui& ui, const KeyEvent& key) {
  if (!key.down || key.control) return;
  if (key.key == Key::character) ui.send(command::TypeLabel{key.character});
  if (key.key == Key::backspace) ui.send(command::TypeLabel{8});
  if (key.key == Key::enter) ui.send(command::NewExam{});
}

void pressed(Ui& ui, const View& view, const KeyEvent& key) {
  const ReviewView& review = view.review;
  switch (key.key) {
    case Key::f1:
      ui.send(command::OpenSheet{Sheet::help, Source::scanner});
      return;
    case Key::f11:
      ui.send(command::ToggleFullScreen{});
      return;
    case Key::left:
      ui.send(command::StepFrames{-1});
      return;
    case Key::right:
      ui.send(command::StepFrames{1});
      return;
    case Key::page_up:
      ui.send(command::StepFrames{-10});
      return;
    case Key::page_down:
      ui.send(command::StepFrames{10});
      return;
    case Key::home:
      ui.send(command::ShowFrame{0});
      return;
    case Key::end:
      ui.send(command::ShowFrame{static_cast<std::int32_t>(review.frames.size()) - 1});
      return;
    case Key::up:
      ui.send(command::PushPlane{-review.plane.pixel_mm});
      return;
    case Key::down:
      ui.send(command::PushPlane{review.plane.pixel_mm});
      return;
    case Key::escape:
      if (review.full != Window::none) ui.send(command::FillPage{Window::none});
      return;
    case Key::backspace:
    case Key::enter:
      return;
    case Key::character:
      break;
  }
  if (key.control) {
    if (key.character == U'z' && !key.shift) ui.send(command::UndoCurve{});
    if (key.character == U'y' || (key.character == U'z' && key.shift)) ui.send(command::RedoCurve{});
    if (key.character == U'q') ui.send(command::Quit{});
    if (key.character == U's') ui.send(command::Snapshot{review.full});
    return;
  }
  switch (key.character) {
    case U'1':
      ui.send(command::GoTo{Page::live});
      break;
    case U'2':
      ui.send(command::GoTo{Page::review});
      break;
    case U'3':
      ui.send(command::GoTo{Page::exams});
      break;
    case U'4':
      ui.send(command::GoTo{Page::set_up});
      break;
    case U'?':
      ui.send(command::OpenSheet{Sheet::help, Source::scanner});
      break;
    case U'p':
      ui.send(command::Play{!review.playing});
      break;
    case U'v':
      ui.send(command::ChooseTool{Tool::move});
      break;
    case U'c':
      ui.send(command::ChooseTool{Tool::curve});
      break;
    case U'm':
      ui.send(command::ChooseTool{Tool::landmark});
      break;
    case U'd':
      ui.send(command::ChooseTool{Tool::measure});
      break;
    case U'o':
      ui.send(command::ChooseTool{Tool::contour});
      break;
    case U'+':
      ui.send(command::SetThickness{review.settings.band.thickness_mm + 1});
      break;
    case U'-':
      ui.send(command::SetThickness{std::max(0.0, review.settings.band.thickness_mm - 1)});
      break;
    default:
      break;
  }
}

}  // namespace

void send_shortcuts(Ui& ui, const View& view, const Input& input) {
  for (const KeyEvent& key : input.keys) {
    if (view.sheet == Sheet::new_exam) {
      if (key.key == Key::escape && key.down) {
        ui.send(command::OpenSheet{});
      } else {
        typed(ui, key);
      }
      continue;
    }
    if (key.key == Key::character && key.character == U' ') {
      if (!key.repeat) ui.send(command::Pedal{key.down});
      continue;
    }
    if (!key.down) continue;
    if (view.sheet != Sheet::none && key.key == Key::escape) {
      ui.send(command::OpenSheet{});
      continue;
    }
    pressed(ui, view, key);
  }
}

}  // namespace sonoband::ui
