#include "ui/panels/contours.h"

#include <algorithm>

#include "ui/interact/cross.h"

namespace sonoband::ui {

bool lies_in(const ContourView& contour, const ReslicePlane& plane, double half_band_mm) {
  if (!contour.on_plane) return false;
  return std::all_of(contour.points_world.begin(), contour.points_world.end(), [&](const Eigen::Vector3d& p) {
    return std::abs(on_plane(plane, p).off_mm) <= half_band_mm + mark_reach_mm;
  });
}

bool in_sight(const ContourView& contour, const ReviewView& review) {
  return contour.frame == review.current ||
         lies_in(contour, review.plane, review.settings.band.thickness_mm / 2);
}

}  // namespace sonoband::ui
