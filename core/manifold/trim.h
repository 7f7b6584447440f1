// What of an offset lies too near to another edge of the curve: closed forms in the frame of one element,
// with x along it and y out of it. Not for use outside.
//
// At height h the part of an element that is nearer than h to a segment is one interval, because the points
// within h of a segment (a capsule: two discs and a slab) are convex and its outline meets a circle of radius
// h at most twice. A point stays lost once it is lost: the discs of growing radius that touch the curve at
// one place contain each other.
#pragma once

#include <array>
#include <limits>

#include "core/manifold/plane_point.h"

namespace sonoband::flow {

// Distances count as equal within this share of the height; equal is not nearer. So a parallel part of the
// curve at exactly twice the height takes nothing away. Rounding is some 1e-14; a larger share would move the
// shock of two edges that meet at 0.01 rad by a hundred times itself.
constexpr double equal_share = 1e-11;

constexpr double never = std::numeric_limits<double>::infinity();

// Open interval; empty when not from < to.
struct Cut {
  double from = never, to = -never;

  bool empty() const { return !(from < to); }
  void add(double a, double b) {
    if (!(a < b)) return;
    from = std::min(from, a);
    to = std::max(to, b);
  }
};

// The radius at which a disc that touches the origin from the direction `out` (unit) reaches a point or a
// segment. 0 when the segment leaves the origin towards out.
double touch_radius(const PlanePoint& out, const PlanePoint& q);
double touch_radius(const PlanePoint& out, const PlanePoint& a, const PlanePoint& b);

// A lower bound, exact unless the segment lies over the edge, of the height at which the parallel of the edge
// from (0, 0) to (length, 0) first comes near to it.
double first_touch(double length, const PlanePoint& a, const PlanePoint& b);

// Of the parallel at height h, as x.
Cut cut_parallel(double h, const PlanePoint& a, const PlanePoint& b);

// Parts of an arc; they may overlap. What is lost is one interval of the circle, but on an arc it may be both
// ends.
struct ArcCuts {
  std::array<Cut, 24> cuts;
  int count = 0;
};

// Of the arc of radius h about the origin, as angle from +y towards +x, for arcs within half a turn centred
// on +y.
ArcCuts cut_arc(double h, double half_angle, const PlanePoint& a, const PlanePoint& b);

}  // namespace sonoband::flow
