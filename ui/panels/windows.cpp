#include "ui/panels/windows.h"

namespace sonoband::ui {

Icon corner_icon(const View& view, Window window) {
  return view.review.full == window ? Icon::shrink : Icon::grow;
}

void toggle_full(Ui& ui, const View& view, Window window, const PanelFrame& frame) {
  if (frame.title_tapped) ui.send(command::FillPage{view.review.full == window ? Window::none : window});
}

void tell_touching(Ui& ui, std::uint64_t id) {
  for (const Gesture& g : ui.gestures) {
    if (g.target != id) continue;
    if (g.phase == Gesture::Phase::begin) ui.send(command::Touching{true});
    if (g.phase == Gesture::Phase::end) ui.send(command::Touching{false});
  }
}

void tell_pushing(Ui& ui, std::uint64_t id) {
  for (const Gesture& g : ui.gestures)
    if (g.target == id && g.kind == Gesture::Kind::press) ui.send(command::AboutToPush{});
  tell_touching(ui, id);
}

Sides sides_of(const ReviewView& review) {
  const auto& m = review.frames[review.frames.size() / 2]->world_from_image.linear;
  return {m.col(0).normalized(), m.col(1).normalized()};
}

Vec2 seen(const Eigen::Vector3d& direction, const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
  return {static_cast<float>(direction.dot(right)), static_cast<float>(direction.dot(down))};
}

}  // namespace sonoband::ui
