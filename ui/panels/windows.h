// What the four linked windows of Review share.
#pragma once

#include <string_view>

#include "core/reslice/band.h"
#include "ui/controls.h"
#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// What stands over a window of Review. A tap on it fills the page with the window, and back.
struct WindowTitle {
  Window window = Window::none;
  std::string_view name;         // of the widget that is the title
  std::string_view corner_name;  // of the one in the corner, where the title does not reach that far
  std::string_view title;
  std::string_view detail;
};

// Has no height to spare: its title and tools lie over the picture, which then is a third higher.
bool is_low(const Ui& ui, const Rect& window);
// The ground, and the title of a window that is not low; returns what is left inside.
Rect begin_window(Ui& ui, const Rect& r, const View& view, const WindowTitle& title);
// After what is in it: what the title hears, and a low window's title, over it.
void end_window(Ui& ui, const Rect& r, const View& view, const WindowTitle& title);
// Of a low window: room for some words under its title, at the left edge.
Rect beside_title(const Ui& ui, const Rect& window);
// Of a picture that fills `inside`: the part that a title over it leaves free.
Rect below_title(const Ui& ui, const Rect& window, const Rect& inside);

// Says when a finger lands on and leaves a widget that changes a rendering.
void tell_touching(Ui& ui, std::uint64_t id);
// The same of a widget that pushes the plane along its normal or makes the band thicker.
void tell_pushing(Ui& ui, std::uint64_t id);

// Of the sweep's middle B-scan, which stands for all: where its marked side is, and what lies deep.
struct Sides {
  Eigen::Vector3d marked;
  Eigen::Vector3d deep;
};
Sides sides_of(const ReviewView& review);
// A direction in a picture whose sides are `right` and `down`.
Vec2 seen(const Eigen::Vector3d& direction, const Eigen::Vector3d& right, const Eigen::Vector3d& down);

}  // namespace sonoband::ui
