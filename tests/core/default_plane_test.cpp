// The plane to begin with lies across the frames, for a sweep whose every frame is known.
#include "core/reslice/default_plane.h"

#include <gtest/gtest.h>

#include <vector>

namespace sonoband {
namespace {

// Frames of 11 x 21 pixels of 0.5 mm, x along X, y along Y, `spacing` mm apart along Z.
struct StraightSweep {
  StraightSweep(int count, double spacing) : pixels(11, 21), frames(count) {
    for (int i = 0; i < count; ++i) {
      Affine<frame::World, frame::Image> world_from_image;
      world_from_image.linear *= 0.5;
      world_from_image.translation = {0, 0, i * spacing};
      frames[i].bscan.pixels = pixels.view();
      set_pose(frames[i], world_from_image);
      pointers.push_back(&frames[i]);
    }
  }
  SweepView view() const { return {pointers, {}}; }

  Pixels pixels;
  std::vector<TrackedFrame> frames;
  std::vector<const TrackedFrame*> pointers;
};

TEST(DefaultPlane, LiesAcrossTheFramesAndHoldsThemAll) {
  const StraightSweep sweep(5, 1.0);
  const auto plane = default_plane(sweep.view(), PlaneView::level, 0.5);
  ASSERT_TRUE(plane);
  EXPECT_TRUE(plane->right.v.isApprox(Eigen::Vector3d::UnitZ(), 1e-9)) << plane->right.v.transpose();
  EXPECT_TRUE(plane->down.v.isApprox(Eigen::Vector3d::UnitX(), 1e-9)) << plane->down.v.transpose();
  EXPECT_TRUE(plane->origin.v.isApprox(Eigen::Vector3d(0, 5, 0), 1e-9)) << plane->origin.v.transpose();
  EXPECT_EQ(plane->width, 9);    // 4 mm of travel
  EXPECT_EQ(plane->height, 11);  // 5 mm of picture
  EXPECT_EQ(plane->pixel_mm, 0.5);
}

TEST(DefaultPlane, UprightRunsFromTheProbeIntoTheBody) {
  const StraightSweep sweep(5, 1.0);
  const auto plane = default_plane(sweep.view(), PlaneView::upright, 0.2);
  ASSERT_TRUE(plane);
  EXPECT_TRUE(plane->right.v.isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_TRUE(plane->down.v.isApprox(Eigen::Vector3d::UnitY(), 1e-9));
  EXPECT_TRUE(plane->origin.v.isApprox(Eigen::Vector3d(1, 0, 0), 1e-9)) << plane->origin.v.transpose();
  EXPECT_EQ(plane->width, 9);
  EXPECT_EQ(plane->height, 21);
}

TEST(DefaultPlane, AProbeThatDidNotTravelIsSeenAlongItsNormal) {
  const StraightSweep sweep(4, 0.0);
  const auto plane = default_plane(sweep.view(), PlaneView::level, 0.0);
  ASSERT_TRUE(plane);
  EXPECT_TRUE(plane->right.v.isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_EQ(plane->width, 1);
}

TEST(DefaultPlane, NoFramesNoPlane) {
  EXPECT_FALSE(default_plane({}));
}

}  // namespace
}  // namespace sonoband
