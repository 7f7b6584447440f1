#include "ui/interact/outline_view.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace sonoband::ui {
namespace {

struct Hit {
  float distance_px = 0;
  double depth_mm = 0;
};

Hit distance_to(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Vec2 p) {
  const Vec2 a2{static_cast<float>(a.x()), static_cast<float>(a.y())};
  const Vec2 b2{static_cast<float>(b.x()), static_cast<float>(b.y())};
  const Vec2 ab = b2 - a2;
  const float square = dot(ab, ab);
  const float t = square > 0 ? std::clamp(dot(p - a2, ab) / square, 0.0f, 1.0f) : 0;
  return {length(p - (a2 + t * ab)), a.z() + t * (b.z() - a.z())};
}

}  // namespace

std::array<Eigen::Vector3d, 4> corners_of(const Affine<frame::World, frame::Image>& world_from_image,
                                          int width, int height) {
  const auto place = [&](double x, double y) {
    return (world_from_image * Point<frame::Image>{{x, y, 0}}).v;
  };
  const double right = width - 0.5;
  const double deep = height - 0.5;
  return {place(-0.5, -0.5), place(right, -0.5), place(right, deep), place(-0.5, deep)};
}

std::array<Eigen::Vector3d, 4> corners_of(const TrackedFrame& f) {
  return corners_of(f.world_from_image, f.bscan.pixels.width, f.bscan.pixels.height);
}

SweepFrame frame_of(std::span<const TrackedFrame* const> frames) {
  SweepFrame sweep;
  if (frames.empty()) return sweep;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e30);
  Eigen::Vector3d high = -low;
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  Eigen::Vector3d deep = Eigen::Vector3d::Zero();
  for (const TrackedFrame* f : frames) {
    for (const Eigen::Vector3d& c : corners_of(*f)) {
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    across += f->world_from_image.linear.col(0);
    deep += f->world_from_image.linear.col(1);
  }
  sweep.centre = 0.5 * (low + high);
  sweep.radius_mm = 0;
  for (const TrackedFrame* f : frames) {
    for (const Eigen::Vector3d& c : corners_of(*f)) {
      sweep.radius_mm = std::max(sweep.radius_mm, (c - sweep.centre).norm());
    }
  }
  sweep.radius_mm = std::max(sweep.radius_mm, 1.0);
  // Frames that turn right round may sum to nothing; the first one's axes serve then.
  if (across.norm() < 1e-9 || deep.norm() < 1e-9 ||
      across.cross(deep).norm() < 1e-3 * across.norm() * deep.norm()) {
    across = frames.front()->world_from_image.linear.col(0);
    deep = frames.front()->world_from_image.linear.col(1);
  }
  deep.normalize();
  across = (across - deep.dot(across) * deep).normalized();
  sweep.axes.col(0) = across;
  sweep.axes.col(1) = deep;
  sweep.axes.col(2) = across.cross(deep);
  return sweep;
}

SweepFrame frame_of(const std::array<Eigen::Vector3d, 4>& corners) {
  SweepFrame sweep;
  sweep.centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  sweep.radius_mm = 0;
  for (const Eigen::Vector3d& c : corners)
    sweep.radius_mm = std::max(sweep.radius_mm, (c - sweep.centre).norm());
  const Eigen::Vector3d deep = (corners[3] - corners[0]).normalized();
  Eigen::Vector3d across = corners[1] - corners[0];
  across = (across - deep.dot(across) * deep).normalized();
  sweep.axes.col(0) = across;
  sweep.axes.col(1) = deep;
  sweep.axes.col(2) = across.cross(deep);
  return sweep;
}

OutlineView::OutlineView(const SweepFrame& sweep, const Orbit& orbit, const Rect& window) {
  // At rest the eye looks along the sweep's rows, so that the sweep's length runs across the window.
  const Eigen::Vector3d along = sweep.axes.col(2);
  const Eigen::Vector3d deep = sweep.axes.col(1);
  const Eigen::Vector3d across = sweep.axes.col(0);
  const double c = std::cos(orbit.turn_rad);
  const double s = std::sin(orbit.turn_rad);
  const Eigen::Vector3d right = c * along + s * across;
  const Eigen::Vector3d level_away = right.cross(deep);  // right-handed: right, down, away
  const double cr = std::cos(orbit.rise_rad);
  const double sr = std::sin(orbit.rise_rad);
  eye_from_world_.row(0) = right;
  eye_from_world_.row(1) = cr * deep - sr * level_away;
  eye_from_world_.row(2) = cr * level_away + sr * deep;
  centre_ = sweep.centre;
  const float smaller = std::min(window.width, window.height);
  // The sphere round all corners is loose: most sweeps are boxes, seen from a corner only now and then.
  constexpr double fill = 1.12;
  px_per_mm_ = 0.5 * smaller * fill * orbit.zoom / sweep.radius_mm;
  middle_ = window.centre() + Vec2{static_cast<float>(orbit.slide.x() * smaller),
                                   static_cast<float>(orbit.slide.y() * smaller)};
}

Eigen::Vector3d OutlineView::seen(const Eigen::Vector3d& p_world) const {
  const Eigen::Vector3d e = eye_from_world_ * (p_world - centre_);
  return {middle_.x + px_per_mm_ * e.x(), middle_.y + px_per_mm_ * e.y(), e.z()};
}

Vec2 OutlineView::at(const Eigen::Vector3d& p_world) const {
  const Eigen::Vector3d s = seen(p_world);
  return {static_cast<float>(s.x()), static_cast<float>(s.y())};
}

void outlines_apart(std::span<const TrackedFrame* const> frames, const OutlineView& view, float least_px,
                    std::vector<int>& shown) {
  shown.clear();
  std::array<Vec2, 4> last{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto corners = corners_of(*frames[i]);
    std::array<Vec2, 4> here{};
    float moved = 0;
    for (std::size_t k = 0; k < here.size(); ++k) {
      here[k] = view.at(corners[k]);
      moved = std::max(moved, length(here[k] - last[k]));
    }
    if (i != 0 && i + 1 != frames.size() && moved < least_px) continue;
    shown.push_back(static_cast<int>(i));
    last = here;
  }
}

std::optional<int> pick_outline(std::span<const TrackedFrame* const> frames, const OutlineView& view, Vec2 at,
                                float within_px) {
  constexpr float as_near_px = 2;
  std::optional<int> best;
  Hit best_hit{within_px, 0};
  for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
    const auto corner = corners_of(*frames[i]);
    Hit hit{1e30f, 0};
    // The arch: left side, skin, right side; the deep side is open.
    constexpr std::array<std::pair<int, int>, 3> sides = {{{3, 0}, {0, 1}, {1, 2}}};
    for (const auto& [a, b] : sides) {
      const Hit h = distance_to(view.seen(corner[a]), view.seen(corner[b]), at);
      if (h.distance_px < hit.distance_px) hit = h;
    }
    if (hit.distance_px > within_px) continue;
    const bool clearly_nearer = hit.distance_px < best_hit.distance_px - as_near_px;
    const bool in_front =
        hit.distance_px < best_hit.distance_px + as_near_px && hit.depth_mm < best_hit.depth_mm;
    if (!best || clearly_nearer || in_front) {
      best = i;
      best_hit = hit;
    }
  }
  return best;
}

}  // namespace sonoband::ui
