// How far the corners of B-scans lie from one another's planes, and which belong to one sweep.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "core/reslice/capture_order.h"

namespace sonoband {

// Of the pixels at the picture's corners, in World.
inline std::array<Eigen::Vector3d, 4> corners(const TrackedFrame& f) {
  const double right = f.bscan.pixels.width - 1;
  const double bottom = f.bscan.pixels.height - 1;
  const auto at = [&](double x, double y) { return (f.world_from_image * Point<frame::Image>{{x, y, 0}}).v; };
  return {at(0, 0), at(right, 0), at(0, bottom), at(right, bottom)};
}

// Signed distances in mm of the corners of `to` from the plane of `from`.
inline std::array<double, 4> corner_distances_mm(const TrackedFrame& from, const TrackedFrame& to) {
  std::array<double, 4> mm;
  const std::array<Eigen::Vector3d, 4> points = corners(to);
  for (std::size_t i = 0; i < points.size(); ++i)
    mm[i] = (from.image_from_world * Point<frame::World>{points[i]}).v.z();
  return mm;
}

// The largest of them without its sign.
inline double corner_distance_mm(const TrackedFrame& from, const TrackedFrame& to) {
  double largest = 0;
  for (const double mm : corner_distances_mm(from, to)) largest = std::max(largest, std::abs(mm));
  return largest;
}

// Indices into frames, sweep by sweep, in order of capture.
inline std::map<std::int32_t, std::vector<int>> by_sweep(const SweepView& sweep) {
  std::map<std::int32_t, std::vector<int>> sweeps;
  for (const int i : capture_order(sweep)) sweeps[sweep.frames[i]->sweep_id].push_back(i);
  return sweeps;
}

}  // namespace sonoband
