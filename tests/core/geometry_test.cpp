// Laws of frames and transforms on random inputs, and one product worked by hand.
#include <gtest/gtest.h>

#include "core/geometry/plane.h"
#include "tests/support/support.h"

namespace sonoband {
namespace {

using TrackerFromProbe = Rigid<frame::Tracker, frame::Probe>;

TEST(Transforms, RigidTimesInverseIsIdentity) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mm(-300, 300);
  for (int i = 0; i < 100; ++i) {
    const TrackerFromProbe t{test::random_rotation(random), {mm(random), mm(random), mm(random)}};
    const Point<frame::Probe> p{{mm(random), mm(random), mm(random)}};
    EXPECT_TRUE((t.inverse() * (t * p)).v.isApprox(p.v, 1e-12));
    EXPECT_TRUE(is_rotation(t.rotation));
  }
}

TEST(Transforms, ProductTouchesAtTheSameFrame) {
  // Quarter turn about z and 10 mm along x, after 0.5 mm pixels.
  const TrackerFromProbe tracker_from_probe{
      Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {10, 0, 0}};
  Affine<frame::Probe, frame::Image> probe_from_image;
  probe_from_image.linear *= 0.5;
  const auto tracker_from_image = tracker_from_probe * probe_from_image;
  const Point<frame::Tracker> p = tracker_from_image * Point<frame::Image>{{4, 2, 0}};
  EXPECT_TRUE(p.v.isApprox(Eigen::Vector3d(9, 2, 0), 1e-12)) << p.v.transpose();
}

TEST(Plane, MakesRightUnitAndDownOrthogonal) {
  const auto plane = make_plane({1, 2, 3}, {2, 0, 0}, {1, 1, 0}, 4, 3, 0.5);
  ASSERT_TRUE(plane);
  EXPECT_TRUE(plane->right.v.isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(plane->down.v.isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(plane->normal().v.isApprox(Eigen::Vector3d::UnitZ()));
}

TEST(Plane, RefusesParallelAxes) {
  EXPECT_FALSE(make_plane({0, 0, 0}, {1, 1, 0}, {-2, -2, 0}, 4, 3, 0.5));
}

}  // namespace
}  // namespace sonoband
