// One job at a time, the newest wins, and what it paints is the core's own picture.
#include "app/screen/render_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "core/reslice/progressive.h"
#include "tests/support/test_sweep.h"

namespace sonoband::test {
namespace {

constexpr double pixel_mm = 0.5;

// 40 B-scans of 80 x 60 pixels, 1 mm apart along z, whose greys tell where they are.
TestSweep make_sweep() {
  TestSweep sweep;
  for (int i = 0; i < 40; ++i) {
    sweep.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * i}, pixel_mm),
              [](int, int, const Eigen::Vector3d& p) {
                return static_cast<std::uint8_t>(128 + 100 * std::sin(0.4 * p.x()) *
                                                           std::cos(0.3 * p.y() + 0.2 * p.z()));
              });
  }
  return sweep;
}

RenderRequest request_on(const TestSweep& sweep) {
  RenderRequest request;
  request.sweep = {sweep.view(), nullptr};
  request.sweep_version = 1;
  request.plane =
      *make_plane({20, 0, 0}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 78, 60, pixel_mm);
  request.curve_plane = request.plane;
  request.settings.band.step_mm = pixel_mm;
  request.settings.band.thickness_mm = 5;
  return request;
}

const std::vector<Eigen::Vector2d> bend = {{5, 10}, {15, 8}, {25, 14}, {33, 22}};

std::shared_ptr<const RenderResult> answer(RenderWorker& worker, const RenderRequest& request) {
  worker.ask(request);
  worker.wait();
  return worker.newest();
}

bool same(const BandImage& a, const BandImage& b) {
  if (a.pixels.width() != b.pixels.width() || a.pixels.height() != b.pixels.height()) return false;
  for (int y = 0; y < a.pixels.height(); ++y) {
    for (int x = 0; x < a.pixels.width(); ++x) {
      if (a.pixels.view()(x, y) != b.pixels.view()(x, y) ||
          a.coverage.view()(x, y) != b.coverage.view()(x, y))
        return false;
    }
  }
  return true;
}

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

ReslicePlane pushed(const RenderRequest& request, int steps) {
  ReslicePlane plane = request.plane;
  plane.origin = plane.origin + (steps * request.settings.band.step_mm) * plane.normal();
  return plane;
}

double equal_share(const BandImage& a, const BandImage& b) {
  int equal = 0;
  for (int y = 0; y < a.pixels.height(); ++y) {
    for (int x = 0; x < a.pixels.width(); ++x)
      equal += a.pixels.view()(x, y) == b.pixels.view()(x, y) ? 1 : 0;
  }
  return static_cast<double>(equal) / (a.pixels.width() * a.pixels.height());
}

// Thick enough for layers to pay.
RenderRequest dragged_request(const TestSweep& sweep) {
  RenderRequest request = request_on(sweep);
  request.settings.band.thickness_mm = 10;
  request.moving = true;
  return request;
}

TEST(RenderWorker, ADragOf200StepsComesOutOfLayersAndEndsWithTheExactPicture) {
  const TestSweep sweep = make_sweep();
  for (const Compounding how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
    RenderRequest request = dragged_request(sweep);
    request.settings.compounding = how;
    RenderWorker worker(2);
    answer(worker, request);
    const RenderRequest begun = request;
    Serial serial;
    for (int i = 1; i <= 200; ++i) {
      request.plane = pushed(begun, i < 100 ? i : 200 - i);
      const auto step = answer(worker, request);
      const BandImage fresh = render_planar(sweep.view(), request.plane, request.settings, serial);
      ASSERT_GE(equal_share(step->planar->band, fresh), 0.995) << "step " << i;
    }
    // The first is how a drag is known.
    EXPECT_GE(worker.counts().from_layers, 190U);
    EXPECT_GT(worker.counts().layer_bytes, 0U);
    EXPECT_FALSE(worker.newest()->planar->exact);
    request.moving = false;
    const auto last = answer(worker, request);
    EXPECT_TRUE(last->planar->exact);
    EXPECT_TRUE(
        same(last->planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
    EXPECT_EQ(answer(worker, request)->planar, last->planar) << "what is exact is not painted again";
  }
}

TEST(RenderWorker, ADragThatDoesNotWaitEndsWithTheExactPictureToo) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = dragged_request(sweep);
  const RenderRequest begun = request;
  RenderWorker worker(2);
  for (int i = 0; i <= 200; ++i) {
    request.plane = pushed(begun, i % 60);
    request.moving = i < 200;
    worker.ask(request);
    if (i % 7 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  worker.wait();
  Serial serial;
  EXPECT_TRUE(same(worker.newest()->planar->band,
                   render_planar(sweep.view(), request.plane, request.settings, serial)));
  const auto counts = worker.counts();
  EXPECT_EQ(counts.done + counts.given_up, counts.asked);
}

TEST(RenderWorker, WhereADragIsAheadItsFirstStepComesOutOfLayersAndSoDoesAThickerBand) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = dragged_request(sweep);
  request.moving = false;
  RenderWorker worker(1);
  const auto still = answer(worker, request);
  EXPECT_EQ(worker.counts().layer_bytes, 0U) << "nothing is got ready for a plane that rests";
  request.drag_ahead = true;
  EXPECT_EQ(answer(worker, request)->planar, still->planar);
  request.drag_ahead = false;
  request.moving = true;
  request.plane = pushed(request, 1);
  answer(worker, request);
  EXPECT_EQ(worker.counts().from_layers, 1U);
  request.settings.band.thickness_mm = 14;
  const auto thicker = answer(worker, request);
  EXPECT_EQ(worker.counts().from_layers, 2U);
  Serial serial;
  EXPECT_GE(equal_share(thicker->planar->band,
                        render_planar(sweep.view(), request.plane, request.settings, serial)),
            0.995);
  request.plane.origin.v += 3 * pixel_mm * request.plane.right.v;
  EXPECT_TRUE(answer(worker, request)->planar->exact) << "a move in the plane is painted whole";
  EXPECT_EQ(worker.counts().from_layers, 2U);
}

TEST(RenderWorker, LayersAreOfOneSweepAndBoundedAndGivenBack) {
  const TestSweep sweep = make_sweep();
  TestSweep other;
  for (int i = 0; i < 40; ++i) {
    other.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * i}, pixel_mm),
              [](int x, int y, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x ^ y); });
  }
  RenderRequest request = dragged_request(sweep);
  request.drag_ahead = true;
  Serial serial;
  RenderWorker worker(1, {}, {.layers_kept = std::chrono::milliseconds(30)});
  answer(worker, request);
  EXPECT_GT(worker.counts().layer_bytes, 0U);
  EXPECT_LE(worker.counts().layer_bytes, RollingBand::most_bytes(request.plane, request.settings));
  // As many frames and the same plane, but another sweep.
  request.sweep.view = other.view();
  request.sweep_version = 2;
  request.drag_ahead = false;
  request.plane = pushed(request, 1);
  const auto of_other = answer(worker, request);
  EXPECT_TRUE(
      same(of_other->planar->band, render_planar(other.view(), request.plane, request.settings, serial)));
  EXPECT_EQ(worker.counts().layer_bytes, 0U);
  request.drag_ahead = true;
  answer(worker, request);
  for (int i = 0; i < 500 && worker.counts().layer_bytes > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(worker.counts().layer_bytes, 0U) << "nobody asks any more";
  const std::size_t needed = RollingBand::most_bytes(request.plane, request.settings);
  RenderWorker small(1, {}, {.layer_bytes = needed - 1});
  for (int i = 0; i < 4; ++i) {
    answer(small, request);
    request.plane = pushed(request, 1);
  }
  EXPECT_EQ(small.counts().from_layers, 0U);
  EXPECT_EQ(small.counts().layer_bytes, 0U);
}

TEST(RenderWorker, MeansOfDopplerAreDraggedWholeAndMaximaThroughAMaskOutOfLayers) {
  TestSweep sweep = make_sweep();
  Pixels mask(80, 60);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) mask.view()(x, y) = x + y > 40 ? 1 : 0;
  sweep.set_mask(std::move(mask));
  for (const auto& f : sweep.frames()) f->bscan.kind = PixelKind::doppler;
  for (const Compounding how : {Compounding::mean, Compounding::maximum}) {
    RenderRequest request = dragged_request(sweep);
    request.settings.compounding = how;
    RenderWorker worker(2);
    Serial serial;
    for (int i = 0; i < 5; ++i) {
      request.plane = pushed(request, 1);
      const auto step = answer(worker, request);
      EXPECT_EQ(step->planar->band.kind, PixelKind::doppler);
      EXPECT_GE(equal_share(step->planar->band,
                            render_planar(sweep.view(), request.plane, request.settings, serial)),
                how == Compounding::mean ? 1.0 : 0.995);
    }
    EXPECT_EQ(worker.counts().from_layers > 0, how == Compounding::maximum);
  }
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

TEST(RenderWorker, WhereTheBudgetIsTooSmallACoarsePictureComesFirstAndOnlyWhileAFingerMoves) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = request_on(sweep);
  request.curve_mm = bend;
  request.reach_mm = 8;
  request.budget_ms = 1e-6;
  std::vector<std::shared_ptr<const RenderResult>> shown;
  RenderWorker* asked = nullptr;
  RenderWorker worker(2, [&] { shown.push_back(asked->newest()); });
  asked = &worker;
  answer(worker, request);
  ASSERT_EQ(shown.size(), 1U) << "no finger, no coarse picture";
  EXPECT_FALSE(shown[0]->planar->coarse);
  request.moving = true;
  request.plane.origin.v += 2 * request.plane.right.v;
  request.curve_plane = request.plane;
  answer(worker, request);
  ASSERT_GE(shown.size(), 3U);
  Serial serial;
  const PlanarPicture& coarse = *shown[1]->planar;
  EXPECT_TRUE(coarse.coarse);
  EXPECT_FALSE(coarse.exact);
  EXPECT_EQ(coarse.plane.width, 39);
  RenderSettings every_second = request.settings;
  every_second.band = coarse_band(request.settings.band, 2);
  every_second.thin_dense_frames = true;  // as for any band under a moving finger
  EXPECT_TRUE(same(coarse.band, render_planar(sweep.view(), coarse.plane, every_second, serial)));
  EXPECT_TRUE(shown[1]->manifold->coarse);
  const RenderResult& last = *shown.back();
  EXPECT_TRUE(last.planar->exact);
  EXPECT_TRUE(same(last.planar->band, render_planar(sweep.view(), request.plane, request.settings, serial)));
  EXPECT_FALSE(last.manifold->coarse);
  EXPECT_EQ(worker.counts().done, 2U);
  EXPECT_GE(worker.counts().coarse, 1U);
  for (std::size_t i = 1; i < shown.size(); ++i) EXPECT_GT(shown[i]->version, shown[i - 1]->version);
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
