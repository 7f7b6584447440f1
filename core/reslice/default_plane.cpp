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

Eigen::Vector3d middle_of(const TrackedFrame& f, double depth) {
  return point_of(f, (f.bscan.pixels.width - 1) / 2.0, (f.bscan.pixels.height - 1) * depth);
}

// Unit, along the longest axis of the frames' middles and pointing from the first to the last.
Eigen::Vector3d travel(const SweepView& sweep, double depth, const Eigen::Vector3d& centre,
                       const Eigen::Vector3d& mean_normal) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const TrackedFrame* f : sweep.frames) {
    const Eigen::Vector3d d = middle_of(*f, depth) - centre;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const double spread_mm =
      std::sqrt(std::max(0.0, axes.eigenvalues()(2)) / static_cast<double>(sweep.frames.size()));
  // Less than a pixel of spread is tracker noise, not a sweep.
  if (spread_mm < pixel_width_mm(sweep)) return mean_normal;
  const Eigen::Vector3d axis = axes.eigenvectors().col(2);
  const Eigen::Vector3d way =
      middle_of(*sweep.frames.back(), depth) - middle_of(*sweep.frames.front(), depth);
  return axis.dot(way) < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace

std::optional<ReslicePlane> default_plane(const SweepView& sweep, double depth) {
  if (sweep.frames.empty()) return std::nullopt;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_x = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_normal = Eigen::Vector3d::Zero();
  for (const TrackedFrame* f : sweep.frames) {
    centre += middle_of(*f, depth);
    mean_x += f->world_from_image.linear.col(0).normalized();
    mean_normal += f->world_from_image.linear.col(2);
  }
  centre /= static_cast<double>(sweep.frames.size());
  const Eigen::Vector3d first_normal = sweep.frames.front()->world_from_image.linear.col(2);
  const Eigen::Vector3d right =
      travel(sweep, depth, centre, mean_normal.norm() > 1e-6 ? mean_normal.normalized() : first_normal);
  const Eigen::Vector3d first_y = sweep.frames.front()->world_from_image.linear.col(1);
  // A probe swept along its own x has no x across the travel; its depth is then the other axis.
  const bool sideways = mean_x.cross(right).norm() < 0.1 * mean_x.norm() || mean_x.norm() < 1e-6;
  auto plane = make_plane(centre, right, sideways ? first_y : mean_x, 1, 1, pixel_width_mm(sweep));
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
