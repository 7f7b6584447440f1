// Drawing the curve c(s) with a finger: the stroke is smoothed as it is drawn, its vertices can be dragged,
// and every change can be undone. Points are in mm of the plane.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sonoband::ui {

// A line of closely spaced points, some of which the user can drag.
struct EditedCurve {
  std::vector<Eigen::Vector2d> line;
  std::vector<int> handles;  // indices into `line`, ascending, first and last point included
};

class CurveEditor {
 public:
  // Spacing of the line's points, usually the plane's pixel; sigma of the smoothing in points.
  explicit CurveEditor(double spacing_mm = 0.4, double smooth_points = 4)
      : spacing_mm_(spacing_mm), smooth_points_(smooth_points) {}

  // A stroke replaces the curve when it ends, unless it is shorter than `least_mm`: then it was a slip of the
  // finger and what was there stays.
  void begin(const Eigen::Vector2d& at);
  void extend(const Eigen::Vector2d& to);
  void end();
  bool drawing() const { return drawing_; }

  // Neighbours of the handle go along, less the farther they are, and none beyond the next handle.
  void grab(int handle);
  void drag(const Eigen::Vector2d& to);  // nothing while none is held
  void drop();
  bool holding() const { return held_ >= 0; }

  // One that was drawn earlier; what was here is forgotten.
  void restore(EditedCurve curve);
  const EditedCurve& kept() const { return now_; }

  void clear();
  void undo();
  void redo();
  bool can_undo() const { return !done_.empty(); }
  bool can_redo() const { return !undone_.empty(); }

  // What to show: the stroke while it is drawn, else the curve.
  const std::vector<Eigen::Vector2d>& line() const { return drawing_ ? preview_ : now_.line; }
  const std::vector<Eigen::Vector2d>& handles() const { return handle_points_; }
  std::uint64_t version() const { return version_; }  // changes with line()

  static constexpr double least_mm = 4;

 private:
  void keep();  // what there is now can be come back to
  void changed();

  double spacing_mm_;
  double smooth_points_;
  EditedCurve now_;
  EditedCurve before_drag_;
  std::vector<Eigen::Vector2d> handle_points_;
  std::vector<Eigen::Vector2d> stroke_;
  std::vector<Eigen::Vector2d> preview_;
  std::vector<EditedCurve> done_;
  std::vector<EditedCurve> undone_;
  int held_ = -1;
  bool drawing_ = false;
  std::uint64_t version_ = 1;
};

}  // namespace sonoband::ui
