#include "tests/support/test_sweep.h"

namespace sonoband::test {

TrackedFrame& TestSweep::add(int width, int height,
                             const Affine<frame::World, frame::Image>& world_from_image,
                             const PixelFormula& value, PixelKind kind, int sweep_id) {
  auto picture = std::make_unique<Pixels>(width, height);
  auto f = std::make_unique<TrackedFrame>();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Point<frame::Image> p{{static_cast<double>(x), static_cast<double>(y), 0}};
      picture->view()(x, y) = value(x, y, (world_from_image * p).v);
    }
  }
  set_pose(*f, world_from_image);
  f->bscan = {picture->view(), kind};
  f->sweep_id = sweep_id;
  f->sequence = static_cast<std::int64_t>(frames_.size());
  f->captured = Stamp{std::chrono::milliseconds(frames_.size())};
  pictures_.push_back(std::move(picture));
  frames_.push_back(std::move(f));
  pointers_.push_back(frames_.back().get());
  return *frames_.back();
}

SweepView TestSweep::view() const {
  return {pointers_, mask_.width() > 0 ? mask_.view() : MaskView{}};
}

SweepView TestSweep::view(const std::vector<int>& order) {
  reordered_.clear();
  for (const int i : order) reordered_.push_back(pointers_[i]);
  return {reordered_, mask_.width() > 0 ? mask_.view() : MaskView{}};
}

Affine<frame::World, frame::Image> image_pose(const Eigen::Matrix3d& world_from_probe,
                                              const Eigen::Vector3d& origin_mm, double pixel_mm) {
  Affine<frame::World, frame::Image> pose;
  pose.linear = world_from_probe;
  pose.linear.col(0) *= pixel_mm;
  pose.linear.col(1) *= pixel_mm;
  pose.translation = origin_mm;
  return pose;
}

}  // namespace sonoband::test
