// Editing a curve by its vertices. Every edit is a pure function of the old curve; undo keeps old values.
#pragma once

#include <cstddef>

#include "core/manifold/curve.h"

namespace sonoband {

// The vertex nearest to a point (of equals the first), for a finger to take hold of. Precondition: there is
// one.
std::size_t nearest_vertex(const Curve& curve, const PlanePoint& p);

// Moves one vertex to `to` and its neighbours within reach_mm of arc length along with it, less and less
// (half a cosine wave), so that a curve of vertices a pixel apart bends instead of growing a spike. Reach 0
// moves the one vertex. Vertices that come to lie on each other stay; hand the result's vertices to
// make_curve before flowing it.
Curve drag_vertex(const Curve& curve, std::size_t vertex, const PlanePoint& to, double reach_mm);

// After the vertex of this index.
Curve insert_vertex(const Curve& curve, std::size_t after, const PlanePoint& p);

// Without the vertex; the curve itself where it would be left with too few.
Curve erase_vertex(const Curve& curve, std::size_t vertex);

// The curve now and as it was, newest last; at most max_undo steps back.
class CurveHistory {
 public:
  static constexpr std::size_t max_undo = 64;

  explicit CurveHistory(Curve first) { states_.push_back(std::move(first)); }

  const Curve& now() const { return states_[at_]; }
  void change(Curve next);  // what had been undone is gone
  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < states_.size(); }
  void undo() { at_ -= can_undo(); }  // nothing to undo: nothing happens
  void redo() { at_ += can_redo(); }

 private:
  std::vector<Curve> states_;
  std::size_t at_ = 0;
};

}  // namespace sonoband
