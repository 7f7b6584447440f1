// Lengths, angles and areas of points in space, in the millimetres of World.
#pragma once

#include <Eigen/Core>
#include <span>

namespace sonoband {

double distance_mm(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// Along a chain of points.
double path_mm(std::span<const Eigen::Vector3d> points);

// At `corner`, between the directions to a and b: 0 to 180. 0 where one of them is the corner itself.
double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& corner, const Eigen::Vector3d& b);

// Of the closed polygon. Exact for one that is plane and does not cross itself; of a bent one the largest
// area of any of its projections onto a plane (half the length of the sum of the edges' cross products).
double area_mm2(std::span<const Eigen::Vector3d> polygon);

}  // namespace sonoband
