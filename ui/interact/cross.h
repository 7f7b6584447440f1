// Where two pictures in space cut each other: the lines that link the windows of Review.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/geometry/plane.h"
#include "core/sweep/tracked_frame.h"
#include "ui/rect.h"

namespace sonoband::ui {

// Both ends, as seen in either picture.
struct Crossing {
  std::array<Eigen::Vector2d, 2> image_px;  // in the B-scan
  std::array<Eigen::Vector2d, 2> plane_mm;  // on the plane, from the centre of its pixel (0,0)
};

// The stretch of the line in which the plane, taken as endless, cuts the B-scan's picture (outer edges of its
// pixels). Empty when it misses the picture or they are parallel.
std::optional<Crossing> crossing(const TrackedFrame& f, const ReslicePlane& plane);

// The line from a to b as far as it lies in `r`; false: it misses.
bool clip_line(Eigen::Vector2d& a, Eigen::Vector2d& b, double left, double top, double right, double bottom);

// A point of World in the frames of the pictures.
struct OnPlane {
  Eigen::Vector2d mm;
  double off_mm = 0;  // along the normal
};
OnPlane on_plane(const ReslicePlane& plane, const Eigen::Vector3d& p_world);
Eigen::Vector3d from_plane(const ReslicePlane& plane, const Eigen::Vector2d& mm);

struct OnImage {
  Eigen::Vector2d px;
  double off_mm = 0;
};
OnImage on_image(const TrackedFrame& f, const Eigen::Vector3d& p_world);
Eigen::Vector3d from_image(const TrackedFrame& f, const Eigen::Vector2d& px);

}  // namespace sonoband::ui
