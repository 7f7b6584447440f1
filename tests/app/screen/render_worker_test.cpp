// One job at a time, the newest wins, and what it paints is the core's own picture.
#include "app/screen/render_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/app/screen/render_support.h"

namespace sonoband::test {
namespace {

using namespace render;

TEST(RenderWorker, PaintsTheCoresBand) {
  const TestSweep sweep = make_sweep();
  const RenderRequest request = request_on(sweep);
  RenderWorker worker(2);
  const auto result = answer(worker, request);
  Serial serial;
  EXPECT_TRUE(
      same(result->planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
  EXPECT_FALSE(result->manifold);
  EXPECT_EQ(worker.counts().done, 1u);
}

TEST(RenderWorker, UnrollsTheCoresManifoldAlongItsColumns) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.curve_mm = bend;
  request.reach_mm = 8;
  RenderWorker worker(2);
  const auto result = answer(worker, request);
  ASSERT_TRUE(result->manifold);
  Serial serial;
  CurveSettings as_drawn{.pixel_mm = pixel_mm, .smooth_px = 0};
  ManifoldSettings settings;
  settings.reach_mm = 8;
  settings.render = request.settings;
  const Curve curve = make_curve(bend, as_drawn).curve;
  const ManifoldBand core = render_manifold(sweep.view(), request.plane, curve, settings, serial);
  const BandImage& shown = result->manifold->band;
  ASSERT_EQ(shown.pixels.width(), core.image.pixels.height());
  ASSERT_EQ(shown.pixels.height(), core.image.pixels.width());
  for (int y = 0; y < shown.pixels.height(); ++y) {
    for (int x = 0; x < shown.pixels.width(); ++x)
      ASSERT_EQ(shown.pixels.view()(x, y), core.image.pixels.view()(y, x)) << x << ", " << y;
  }
  EXPECT_EQ(result->manifold->up, core.up);
  EXPECT_EQ(result->manifold->down, core.down);
  EXPECT_NEAR(result->manifold->length_mm, length_mm(curve), 1e-9);
}

TEST(RenderWorker, WhatDidNotChangeIsNotPaintedAgain) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.curve_mm = bend;
  request.reach_mm = 8;
  RenderWorker worker(1);
  const auto first = answer(worker, request);
  request.plane.origin.v.y() += 1;  // the picture moves, the surface stays
  const auto moved = answer(worker, request);
  EXPECT_NE(moved->planar, first->planar);
  EXPECT_EQ(moved->manifold, first->manifold);
  request.reach_mm = 9;  // the other way round
  const auto higher = answer(worker, request);
  EXPECT_EQ(higher->planar, moved->planar);
  EXPECT_NE(higher->manifold, moved->manifold);
  request.settings.compounding = Compounding::minimum;
  const auto darker = answer(worker, request);
  EXPECT_NE(darker->planar, higher->planar);
  EXPECT_NE(darker->manifold, higher->manifold);
  request.sweep_version = 2;
  EXPECT_NE(answer(worker, request)->planar, darker->planar);
}

TEST(RenderWorker, TheNewestOfManyWinsAndNoneIsHalfAPicture) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.settings.band.thickness_mm = 15;
  RenderWorker worker(2);
  constexpr int many = 200;
  for (int i = 0; i < many; ++i) {
    request.plane.origin.v.x() = 5 + 0.1 * i;
    worker.ask(request);
  }
  worker.wait();
  const auto last = worker.newest();
  EXPECT_EQ(last->planar->plane.origin.v.x(), request.plane.origin.v.x());
  Serial serial;
  EXPECT_TRUE(same(last->planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
  const auto counts = worker.counts();
  EXPECT_EQ(counts.asked, static_cast<std::uint64_t>(many));
  EXPECT_EQ(counts.done + counts.given_up, counts.asked);
  EXPECT_GT(counts.given_up, 0u);
}

// A finger that asks every millisecond for what takes far longer: bands come all the same while it moves.
TEST(RenderWorker, AFingerThatNeverRestsSeesBands) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.plane.width *= 4;
  request.plane.height *= 4;
  request.plane.pixel_mm /= 4;
  request.settings.band.step_mm /= 4;
  request.settings.band.thickness_mm = 40;
  RenderWorker worker(1);
  std::uint64_t while_moving = 0;
  for (int i = 0; i < 3000 && while_moving < 3; ++i) {
    request.plane.origin.v.x() += 0.001;
    worker.ask(request);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto newest = worker.newest();
    while_moving = newest ? newest->version : 0;
  }
  EXPECT_GE(while_moving, 3u);
  worker.wait();
  const auto last = worker.newest();
  EXPECT_EQ(last->planar->plane.origin.v.x(), request.plane.origin.v.x());
  const auto counts = worker.counts();
  EXPECT_EQ(counts.done + counts.given_up, counts.asked);
}

TEST(RenderWorker, DenseFramesAreLeftOutOnlyWhileAFingerMovesThePlane) {
  TestSweep sweep;
  for (int i = 0; i < 200; ++i) {
    sweep.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.1 * i}, pixel_mm),
              [i](int x, int y, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x * y + i); });
  }
  RenderRequest request = dragged_request(sweep);
  RenderWorker worker(1);
  const auto moving = answer(worker, request);
  EXPECT_GT(moving->planar->band.frames_left_out, 100);
  EXPECT_FALSE(moving->planar->exact);
  request.moving = false;
  const auto resting = answer(worker, request);
  EXPECT_EQ(resting->planar->band.frames_left_out, 0);
  Serial serial;
  EXPECT_TRUE(
      same(resting->planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
}

TEST(RenderWorker, LetsGoOfTheSweepOnceItIsPainted) {
  const TestSweep sweep = make_sweep();
  auto keeper = std::make_shared<int>(0);
  RenderWorker worker(1);
  RenderRequest request = request_on(sweep);
  request.sweep.keeper = keeper;
  request.drag_ahead = true;
  worker.ask(std::move(request));
  worker.wait();
  EXPECT_EQ(keeper.use_count(), 1) << "the ring would never get its room back";
}

// A finger so quick that its next step is always there once the band is shown: the manifold follows all the
// same.
TEST(RenderWorker, AFingerThatNeverRestsSeesManifoldsToo) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.curve_mm = bend;
  request.reach_mm = 8;
  request.moving = true;
  constexpr int steps = 60;
  int step = 0;
  int manifolds = 0;
  std::shared_ptr<const ManifoldPicture> seen;
  RenderWorker* asked = nullptr;
  RenderWorker worker(1, [&] {
    const auto newest = asked->newest();
    manifolds += newest->manifold != seen ? 1 : 0;
    seen = newest->manifold;
    if (++step > steps) return;
    request.plane.origin.v += 0.01 * request.plane.right.v;
    request.curve_plane = request.plane;
    asked->ask(request);
  });
  asked = &worker;
  worker.ask(request);
  worker.wait();
  const auto counts = worker.counts();
  EXPECT_GT(counts.given_up, 10U) << "else nothing was left out";
  EXPECT_GE(manifolds, steps / 4);
  EXPECT_EQ(worker.newest()->planar->plane.origin.v, request.plane.origin.v);
}

TEST(RenderWorker, EndsWithAJobInFlight) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.settings.band.thickness_mm = 30;
  std::atomic<int> finished{0};
  {
    RenderWorker worker(2, [&] { ++finished; });
    for (int i = 0; i < 5; ++i) worker.ask(request);
  }
  EXPECT_LE(finished.load(), 5);
}

}  // namespace
}  // namespace sonoband::test
