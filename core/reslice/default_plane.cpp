#include "core/reslice/default_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "core/reslice/band.h"

namespace sonoband {
namespace {

Eigen::Vector3d point_of(const TrackedFrame& f, double x, double y) {
  return (f.world_from_image * Point<frame::Image>{{x, y, 0}}).v;
}

// Where a frame is on the plane: the fraction `at` down its height (level) or across its width (upright).
struct Cut {
  PlaneView view;
  double at;

  Eigen::Vector3d through(const TrackedFrame& f) const {
    const double x = view == PlaneView::level ? 0.5 : at;
    const double y = view == PlaneView::level ? at : 0.5;
    return point_of(f, (f.bscan.pixels.width - 1) * x, (f.bscan.pixels.height - 1) * y);
  }
  Eigen::Vector3d down(const TrackedFrame& f) const {
    return f.world_from_image.linear.col(view == PlaneView::level ? 0 : 1).normalized();
  }
  // When the travel leaves no `down` across it.
  Eigen::Vector3d other(const TrackedFrame& f) const {
    return f.world_from_image.linear.col(view == PlaneView::level ? 1 : 0).normalized();
  }
};

// Unit, along the longest axis of the frames' middles and pointing from the first to the last.
Eigen::Vector3d travel(const SweepView& sweep, const Cut& cut, const Eigen::Vector3d& centre,
                       const Eigen::Vector3d& mean_normal) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const TrackedFrame* f : sweep.frames) {
    const Eigen::Vector3d d = cut.through(*f) - centre;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const double spread_mm =
      std::sqrt(std::max(0.0, axes.eigenvalues()(2)) / static_cast<double>(sweep.frames.size()));
  // Less than a pixel of spread is tracker noise, not a sweep.
  if (spread_mm < pixel_width_mm(sweep)) return mean_normal;
  const Eigen::Vector3d axis = axes.eigenvectors().col(2);
  const Eigen::Vector3d way = cut.through(*sweep.frames.back()) - cut.through(*sweep.frames.front());
  return axis.dot(way) < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace

std::optional<ReslicePlane> default_plane(const SweepView& sweep, PlaneView view, double at) {
  if (sweep.frames.empty()) return std::nullopt;
  const Cut cut{view, at};
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_down = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_normal = Eigen::Vector3d::Zero();
  for (const TrackedFrame* f : sweep.frames) {
    centre += cut.through(*f);
    mean_down += cut.down(*f);
    mean_normal += f->world_from_image.linear.col(2);
  }
  centre /= static_cast<double>(sweep.frames.size());
  const Eigen::Vector3d first_normal = sweep.frames.front()->world_from_image.linear.col(2);
  const Eigen::Vector3d right =
      travel(sweep, cut, centre, mean_normal.norm() > 1e-6 ? mean_normal.normalized() : first_normal);
  // A probe swept along its own x has no x across the travel; its depth is then the other axis.
  const bool along = mean_down.norm() < 1e-6 || mean_down.cross(right).norm() < 0.1 * mean_down.norm();
  auto plane = make_plane(centre, right, along ? cut.other(*sweep.frames.front()) : mean_down, 1, 1,
                          pixel_width_mm(sweep));
  if (!plane) return std::nullopt;

  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d most = -least;
  for (const TrackedFrame* f : sweep.frames) {
    for (const double x : {0.0, f->bscan.pixels.width - 1.0}) {
      for (const double y : {0.0, f->bscan.pixels.height - 1.0}) {
        const Eigen::Vector3d d = point_of(*f, x, y) - centre;
        const Eigen::Vector2d on_plane(d.dot(plane->right.v), d.dot(plane->down.v));
        least = least.cwiseMin(on_plane);
        most = most.cwiseMax(on_plane);
      }
    }
  }
  // 8192 pixels a side: a broken pose must not ask for gigabytes.
  const auto pixels = [&](double extent_mm) {
    return static_cast<int>(std::clamp(std::ceil(extent_mm / plane->pixel_mm) + 1, 1.0, 8192.0));
  };
  plane->width = pixels(most.x() - least.x());
  plane->height = pixels(most.y() - least.y());
  plane->origin.v = centre + least.x() * plane->right.v + least.y() * plane->down.v;
  return plane;
}

}  // namespace sonoband
