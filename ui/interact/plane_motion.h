// What fingers do to the reslice plane. Points are in mm of the plane, from the centre of its pixel (0,0);
// the number of pixels changes only in `shaped`.
#pragma once

#include <Eigen/Core>

#include "core/geometry/plane.h"

namespace sonoband::ui {

// The picture moves by `by_mm` on the screen: what was at m is at m + by_mm.
ReslicePlane moved(const ReslicePlane& plane, const Eigen::Vector2d& by_mm);

// The picture grows by `factor`, what lies at `about_mm` stays where it is on the screen. Pixels stay between
// 0.02 and 2 mm, so the factor carried out may be smaller.
ReslicePlane zoomed(const ReslicePlane& plane, double factor, const Eigen::Vector2d& about_mm);

// A picture of this shape that just holds `width` x `height` pixels, about the same middle.
ReslicePlane shaped(const ReslicePlane& plane, int width, int height, double width_per_height);

// The picture turns clockwise about `about_mm`.
ReslicePlane turned(const ReslicePlane& plane, double by_rad, const Eigen::Vector2d& about_mm);

// What is fixed to `from` goes along as it becomes `to`: the rigid motion between the two, of `plane`.
ReslicePlane carried(const ReslicePlane& plane, const ReslicePlane& from, const ReslicePlane& to);

// Along the normal.
ReslicePlane pushed(const ReslicePlane& plane, double by_mm);

// About the plane's own right axis, then its down axis, both through `about_mm`, right-handed.
ReslicePlane tilted(const ReslicePlane& plane, double about_right_rad, double about_down_rad,
                    const Eigen::Vector2d& about_mm);

}  // namespace sonoband::ui
