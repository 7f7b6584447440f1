// Resampling and smoothing of curves along their arc length.
#pragma once

#include "core/manifold/curve.h"

namespace sonoband {

// round(L / spacing) equal steps (at least one; closed: at least three) along the curve, first and last
// vertex included; a closed curve's seam is not repeated.
std::vector<PlanePoint> resample(const Curve& curve, double spacing_mm);

// Gaussian of the given sigma, in samples, cut off at four sigma. The ends of an open line stay in place:
// what is smoothed is the departure from the chord, continued beyond the ends with the opposite sign. So a
// straight line stays straight. A closed line is continued round its seam.
std::vector<PlanePoint> smooth_along(const std::vector<PlanePoint>& samples, bool closed, double sigma);

}  // namespace sonoband
