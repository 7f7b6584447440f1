// Where a reslice lies and how it is sampled.
#pragma once

#include <optional>

#include "core/geometry/frames.h"
#include "core/geometry/transforms.h"

namespace sonoband {

// A sampled plane in World. Pixel (x, y) sits at origin + (x right + y down) pixel_mm; pixel centres are at
// integers.
struct ReslicePlane {
  Point<frame::World> origin;                               // centre of pixel (0,0)
  Direction<frame::World> right{Eigen::Vector3d::UnitX()};  // unit
  Direction<frame::World> down{Eigen::Vector3d::UnitY()};   // unit, orthogonal to right
  int width = 0;                                            // pixels along right
  int height = 0;                                           // pixels along down
  double pixel_mm = 0.2;                                    // square pixels; usually that of the B-scans

  // Layers of a band are stacked along it, from -T/2 to +T/2.
  Direction<frame::World> normal() const { return {right.v.cross(down.v)}; }

  // Plane mm (x along right, y along down, z along normal) to World.
  Rigid<frame::World, frame::Plane> world_from_plane() const;
};

// `right` is made unit, `down` orthogonal to it and unit; empty when they are parallel, zero or not finite.
std::optional<ReslicePlane> make_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& right,
                                       const Eigen::Vector3d& down, int width, int height, double pixel_mm);

}  // namespace sonoband
