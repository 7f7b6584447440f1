// The geometry of the Outline window: where a point of World lands in it, and which B-scan a finger means.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/sweep/tracked_frame.h"
#include "ui/interact/orbit.h"
#include "ui/rect.h"

namespace sonoband::ui {

// The four corners of a B-scan's picture in World, outer edges of its pixels: skin left, skin right, deep
// right, deep left.
std::array<Eigen::Vector3d, 4> corners_of(const Affine<frame::World, frame::Image>& world_from_image,
                                          int width, int height);
std::array<Eigen::Vector3d, 4> corners_of(const TrackedFrame& f);

// The sweep's own axes: `across` along the B-scans' rows, `deep` away from the skin, `along` completes them.
struct SweepFrame {
  Eigen::Vector3d centre{0, 0, 0};
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns across, deep, along
  double radius_mm = 50;                               // of a sphere round all corners
};
SweepFrame frame_of(std::span<const TrackedFrame* const> frames);
// Of one B-scan, whose corners are in the order of corners_of.
SweepFrame frame_of(const std::array<Eigen::Vector3d, 4>& corners);

// Parallel projection: x right and y down in pixels of the window, depth grows away from the eye, in mm.
class OutlineView {
 public:
  OutlineView(const SweepFrame& sweep, const Orbit& orbit, const Rect& window);
  Vec2 at(const Eigen::Vector3d& p_world) const;
  Eigen::Vector3d seen(const Eigen::Vector3d& p_world) const;  // x, y in px, z in mm
  const Eigen::Matrix3d& eye_from_world() const { return eye_from_world_; }
  double px_per_mm() const { return px_per_mm_; }
  const Eigen::Vector3d& centre() const { return centre_; }
  Vec2 middle() const { return middle_; }

 private:
  Eigen::Matrix3d eye_from_world_;  // rows: right, down, away
  Eigen::Vector3d centre_;
  Vec2 middle_;
  double px_per_mm_ = 1;
};

// Which B-scans' outlines to draw where they lie denser than the window shows: the first, the last, and
// between them every one of which some corner is seen at least `least_px` from that of the last one before.
// Replaces what is in `shown`: indices into `frames`.
void outlines_apart(std::span<const TrackedFrame* const> frames, const OutlineView& view, float least_px,
                    std::vector<int>& shown);

// The B-scan whose arch is nearest to `at`, at most `within_px` away; of several within 2 px of the nearest
// the one nearest to the eye. Empty when there is none.
std::optional<int> pick_outline(std::span<const TrackedFrame* const> frames, const OutlineView& view, Vec2 at,
                                float within_px);

}  // namespace sonoband::ui
