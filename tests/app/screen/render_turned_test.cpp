// When the worker keeps a sweep's pictures turned, and when their memory goes.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/app/screen/render_support.h"

namespace sonoband::test {
namespace {

using namespace render;

// Its lines run down pixel columns.
RenderRequest longitudinal_request(const TestSweep& sweep) {
  RenderRequest request = request_on(sweep);
  request.plane =
      *make_plane({20, 0, 0}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 60, 78, pixel_mm);
  return request;
}

TEST(RenderWorker, KeepsPicturesTurnedForPlanesThatNeedThemOnceASweepNoLongerChanges) {
  const TestSweep sweep = make_sweep();
  Serial serial;
  RenderWorker worker(1);
  RenderRequest request = longitudinal_request(sweep);
  const auto first = answer(worker, request);
  ASSERT_TRUE(first->planar->band.turned_parts);
  request.sweep_version = 2;
  request.plane = pushed(request, 1);
  answer(worker, request);
  EXPECT_EQ(worker.counts().turned_bytes, 0U) << "a growing sweep has another version with every picture";
  request.plane = pushed(request, 1);
  EXPECT_TRUE(answer(worker, request)->planar->band.turned_parts);
  EXPECT_EQ(worker.counts().turned_bytes, 40U * 80 * 64);
  request.plane = pushed(request, 1);
  const auto kept = answer(worker, request);
  EXPECT_FALSE(kept->planar->band.turned_parts);
  EXPECT_TRUE(same(kept->planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
}

TEST(RenderWorker, KeepsNoPicturesTurnedOfAnotherSweepNorMoreThanAllowedNorForLong) {
  const TestSweep sweep = make_sweep();
  TestSweep other;
  for (int i = 0; i < 40; ++i) {
    other.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * i}, pixel_mm),
              [](int x, int y, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x ^ y); });
  }
  Serial serial;
  RenderWorker worker(1, {}, {.layers_kept = std::chrono::milliseconds(30)});
  RenderRequest request = longitudinal_request(sweep);
  const auto twice = [](RenderWorker& on, RenderRequest& r) {
    for (int i = 0; i < 2; ++i) {
      answer(on, r);
      r.plane = pushed(r, 1);
    }
  };
  twice(worker, request);
  request.sweep.view = other.view();
  request.sweep_version = 2;
  const auto of_other = answer(worker, request);
  EXPECT_TRUE(
      same(of_other->planar->band, render_planar(other.view(), request.plane, request.settings, serial)));
  EXPECT_EQ(worker.counts().turned_bytes, 0U);
  twice(worker, request);
  for (int i = 0; i < 500 && worker.counts().turned_bytes > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(worker.counts().turned_bytes, 0U) << "nobody asks any more";
  RenderWorker small(1, {}, {.turned_bytes = 40 * 80 * 64 - 1});
  twice(small, request);
  twice(small, request);
  EXPECT_EQ(small.counts().turned_bytes, 0U);
}

}  // namespace
}  // namespace sonoband::test
