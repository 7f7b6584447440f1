// One side of a curve, made ready for offsetting. What all flow methods share; not for use outside.
//
// Numbers are in steps about the curve's centroid, so that layer k is at distance k, and in frames of their
// own: (along, out), where `out` points to this side. Both sides then obey the same formulas.
#pragma once

#include <optional>

#include "core/manifold/flow.h"

namespace sonoband::flow {

struct Side {
  double sign = 1;  // +1: the side of quarter_turn(direction)
  bool closed = false;

  struct Edge {
    PlanePoint start, along, out;  // along and out are unit
    double length = 0;
  };
  // At the end of the edge of the same index. An open curve has none after its last edge.
  struct Corner {
    PlanePoint at, along, out;  // out bisects the two edges' normals
    double half_angle = 0;  // of the arc of rarefaction, radians; 0 where the corner closes or is straight
    // tan(turn / 2): per unit of distance the edges' parallels meet this much beyond the corner; negative
    // where the corner closes and they meet before it.
    double reach = 0;
  };
  std::vector<Edge> edges;
  std::vector<Corner> corners;
  std::vector<PlanePoint> vertices;  // closed: the first repeated at the end

  const Corner* corner_before(int edge) const {
    if (edge > 0) return &corners[edge - 1];
    return closed ? &corners.back() : nullptr;
  }
  const Corner* corner_after(int edge) const {
    return edge < static_cast<int>(corners.size()) ? &corners[edge] : nullptr;
  }
};

// Edge e is element 2 e, the corner after it 2 e + 1: ascending elements follow the curve.
constexpr int edge_element(int edge) {
  return 2 * edge;
}
constexpr int corner_element(int edge) {
  return 2 * edge + 1;
}

// A part of a front: of an edge's parallel, between two lengths along it; or of a corner's arc, between two
// angles from the bisector, ascending along the curve.
struct Piece {
  int element = 0;
  double from = 0, to = 0;
};

// A front: its pieces in the order of the curve.
using Front = std::vector<Piece>;

// Fronts closer than this at their ends are one line. Rounding at shallow shocks stays below it.
constexpr double join_distance = 1e-3;

PlanePoint point_at(const Side& side, int element, double at, double height);

// The nearest parameter in [from, to] of the element to a point.
double nearest_at(const Side& side, int element, const PlanePoint& p, double from, double to);

// Where a ruling stands: on an edge, or on a corner's arc when it stands on its vertex.
struct Standing {
  PlanePoint at;
  int element = 0;
  double along = 0;
};

// By how much a curve turns away from the side between two edges, in radians: negative where it turns towards
// it. Turning straight back, to within 1e-9, is a half turn away from both sides.
double turn_away(const PlanePoint& along_before, const PlanePoint& along_after, double sign);

// The curve in steps, and both of its sides.
class OffsetCurve {
 public:
  OffsetCurve(const Curve& curve, double step_mm);

  const Side& side(int sign) const { return sides_[sign > 0 ? 0 : 1]; }
  PlanePoint to_mm(const PlanePoint& p) const { return centroid_mm_ + step_mm_ * p; }
  std::vector<Standing> stand(const Side& side, const std::vector<RulingFoot>& rulings) const;

 private:
  double step_mm_;
  PlanePoint centroid_mm_;
  Side sides_[2];
};

}  // namespace sonoband::flow
