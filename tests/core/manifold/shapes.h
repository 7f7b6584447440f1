// Curves with a name for the laws of curve flow, in mm with a step of 1 mm, so that layer k lies at k.
#pragma once

#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "core/manifold/curve.h"

namespace sonoband::test {

struct Shape {
  std::string name;
  Curve curve;
};
inline std::ostream& operator<<(std::ostream& out, const Shape& shape) {
  return out << shape.name;
}

// Where neither layer 1 nor layer 36 meets another part of the curve except round its own corners.
std::vector<Shape> gentle_shapes();
// Hairpins narrower than the band, pockets, spirals, loops, raw strokes, turns back along the curve.
std::vector<Shape> hard_shapes();
std::vector<Shape> all_shapes();

Curve open_curve(std::vector<PlanePoint> points);
Curve closed_curve(std::vector<PlanePoint> points);
// Two arms of the given length that meet at the origin with this angle between them; opens towards +x.
Curve v_curve(double between_deg, double arm);
Curve circle(double radius, int corners);
// As a hand draws: a wandering line of `points` points 2 mm apart; jitter is the deviation of each, in mm.
std::vector<PlanePoint> stroke(unsigned seed, int points, double jitter);

// Points drawn from habits that break geometry: repeats, collinear runs, coordinates on a lattice, tiny and
// huge steps, straight returns, and now and then what is not a number.
std::vector<PlanePoint> nasty_stroke(std::mt19937& random);

Curve reversed(const Curve& curve);

// Distance of a point from the curve, edge by edge.
double distance_to_curve(const PlanePoint& p, const Curve& curve);
double distance_to_lines(const PlanePoint& p, const std::vector<PlaneLine>& lines);

}  // namespace sonoband::test
