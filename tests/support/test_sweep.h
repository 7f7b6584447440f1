// Sweeps made in memory for tests and benchmarks: pictures filled from a formula, poses given.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/sweep/tracked_frame.h"

namespace sonoband::test {

// Owns pictures and frames; view() borrows. Frames are 1 ms apart unless moved by hand.
class TestSweep {
 public:
  TestSweep() = default;
  TestSweep(TestSweep&&) = default;
  TestSweep& operator=(TestSweep&&) = default;

  // Pixel (x, y) of the picture gets value(x, y, world position of its centre).
  using PixelFormula = std::function<std::uint8_t(int x, int y, const Eigen::Vector3d& world_mm)>;
  TrackedFrame& add(int width, int height, const Affine<frame::World, frame::Image>& world_from_image,
                    const PixelFormula& value, PixelKind kind = PixelKind::grey, int sweep_id = 0);

  void set_mask(Pixels mask) { mask_ = std::move(mask); }
  // Frames in the order they were added, or in `order`.
  SweepView view() const;
  SweepView view(const std::vector<int>& order);
  std::vector<std::unique_ptr<TrackedFrame>>& frames() { return frames_; }
  const std::vector<std::unique_ptr<Pixels>>& pictures() const { return pictures_; }

 private:
  std::vector<std::unique_ptr<Pixels>> pictures_;
  std::vector<std::unique_ptr<TrackedFrame>> frames_;
  std::vector<const TrackedFrame*> pointers_;
  std::vector<const TrackedFrame*> reordered_;
  Pixels mask_;
};

// A pose with square pixels: columns of `world_from_probe` are x, y and the normal.
Affine<frame::World, frame::Image> image_pose(const Eigen::Matrix3d& world_from_probe,
                                              const Eigen::Vector3d& origin_mm, double pixel_mm);

}  // namespace sonoband::test
