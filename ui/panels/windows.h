// What the four linked windows of Review share.
#pragma once

#include "core/reslice/band.h"
#include "ui/controls.h"
#include "ui/ui.h"
#include "ui/view.h"

namespace sonoband::ui {

// A tap on its title fills the page with a window, and back.
Icon corner_icon(const View& view, Window window);
void toggle_full(Ui& ui, const View& view, Window window, const PanelFrame& frame);

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
