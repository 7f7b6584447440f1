#include "ui/interact/curve_editor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/manifold/curve.h"
#include "core/manifold/smooth.h"

namespace sonoband::ui {
namespace {

constexpr std::size_t most_steps = 200;     // that can be undone
constexpr std::size_t most_points = 20000;  // of one stroke: half a minute of a fast finger

double length_of(const std::vector<Eigen::Vector2d>& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += (line[i] - line[i - 1]).norm();
  return sum;
}

std::vector<Eigen::Vector2d> smoothed(const std::vector<Eigen::Vector2d>& stroke, double spacing_mm,
                                      double points) {
  if (stroke.size() < 2 || !(length_of(stroke) > 0)) return stroke;
  Curve curve;
  curve.vertices = stroke;
  return smooth_along(resample(curve, spacing_mm), false, points);
}

// Handles some 12 mm apart, at least 3 and at most 12: apart enough for fingers, near enough to bend the
// curve.
std::vector<int> handles_of(const std::vector<Eigen::Vector2d>& line) {
  constexpr double apart_mm = 12;
  std::vector<int> all;
  if (line.size() < 2) return all;
  const int last = static_cast<int>(line.size()) - 1;
  const int spans =
      std::min(last, std::clamp(static_cast<int>(std::lround(length_of(line) / apart_mm)), 2, 11));
  for (int i = 0; i <= spans; ++i)
    all.push_back(static_cast<int>(std::lround(static_cast<double>(i) * last / spans)));
  return all;
}

}  // namespace

void CurveEditor::begin(const Eigen::Vector2d& at) {
  drop();
  drawing_ = true;
  stroke_.assign(1, at);
  preview_ = stroke_;
  changed();
}

void CurveEditor::extend(const Eigen::Vector2d& to) {
  if (!drawing_ || stroke_.size() >= most_points) return;
  // Reports of a resting finger would pile up at one place.
  if ((to - stroke_.back()).norm() < 0.5 * spacing_mm_) return;
  stroke_.push_back(to);
  preview_ = smoothed(stroke_, spacing_mm_, smooth_points_);
  changed();
}

void CurveEditor::end() {
  if (!drawing_) return;
  drawing_ = false;
  if (length_of(preview_) >= least_mm) {
    keep();
    now_.line = preview_;
    now_.handles = handles_of(now_.line);
  }
  changed();
}

void CurveEditor::grab(int handle) {
  drop();
  if (drawing_ || handle < 0 || handle >= static_cast<int>(now_.handles.size())) return;
  held_ = handle;
  before_drag_ = now_;
}

void CurveEditor::drag(const Eigen::Vector2d& to) {
  if (held_ < 0) return;
  const std::vector<int>& handles = now_.handles;
  const int middle = handles[held_];
  const int from = held_ > 0 ? handles[held_ - 1] : middle;
  const int until = held_ + 1 < static_cast<int>(handles.size()) ? handles[held_ + 1] : middle;
  const Eigen::Vector2d by = to - before_drag_.line[middle];
  for (int i = from; i <= until; ++i) {
    const int side = i < middle ? middle - from : until - middle;
    const double far = side > 0 ? static_cast<double>(std::abs(i - middle)) / side : 0;
    const double weight = 0.5 * (1 + std::cos(std::numbers::pi * far));
    now_.line[i] = before_drag_.line[i] + weight * by;
  }
  changed();
}

void CurveEditor::drop() {
  if (held_ < 0) return;
  held_ = -1;
  if (now_.line == before_drag_.line) return;
  EditedCurve after = now_;
  now_ = before_drag_;
  keep();
  now_ = std::move(after);
  changed();
}

void CurveEditor::restore(EditedCurve curve) {
  drawing_ = false;
  held_ = -1;
  done_.clear();
  undone_.clear();
  now_ = std::move(curve);
  changed();
}

void CurveEditor::clear() {
  if (now_.line.empty()) return;
  drop();
  keep();
  now_ = {};
  changed();
}

void CurveEditor::undo() {
  drop();
  if (done_.empty()) return;
  undone_.push_back(now_);
  now_ = std::move(done_.back());
  done_.pop_back();
  changed();
}

void CurveEditor::redo() {
  drop();
  if (undone_.empty()) return;
  done_.push_back(now_);
  now_ = std::move(undone_.back());
  undone_.pop_back();
  changed();
}

void CurveEditor::keep() {
  if (done_.size() == most_steps) done_.erase(done_.begin());
  done_.push_back(now_);
  undone_.clear();
}

void CurveEditor::changed() {
  ++version_;
  handle_points_.clear();
  for (const int i : now_.handles) handle_points_.push_back(now_.line[i]);
}

}  // namespace sonoband::ui
