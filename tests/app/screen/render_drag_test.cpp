// Bands under a finger that pushes the plane: out of layers, near enough while it moves, exact when it rests.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/app/screen/render_support.h"

namespace sonoband::test {
namespace {

using namespace render;

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

}  // namespace
}  // namespace sonoband::test
