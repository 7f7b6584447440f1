// In which order the pictures of one request come, and which of them are painted at all.
#include "app/screen/request_painter.h"

#include <gtest/gtest.h>

#include "core/reslice/progressive.h"
#include "tests/app/screen/render_support.h"

namespace sonoband::test {
namespace {

using namespace render;

// A painter on this thread, and what it showed before its answers.
struct Easel {
  RenderResult answer(const RenderRequest& request) {
    shown.clear();
    overtaken = false;
    PreparedSweep sweep(request.sweep.view, request.settings.gap);
    RenderResult result = painter.answer(request, sweep, [&](RenderResult some) {
      shown.push_back(std::move(some));
      overtaken = gives_up;
      return !gives_up;
    });
    if (!overtaken) painter.keep(request, result);
    return result;
  }
  Serial serial;
  StopFlag overtaken{false};
  bool gives_up = false;  // once something is shown
  RequestPainter painter{{serial, serial, overtaken}, std::size_t{64} << 20, 0};
  std::vector<RenderResult> shown;
};

RenderRequest curved_request(const TestSweep& sweep) {
  RenderRequest request = request_on(sweep);
  request.curve_mm = bend;
  request.reach_mm = 8;
  return request;
}

void move_all(RenderRequest& request) {
  request.plane = pushed(request, 2);
  request.curve_plane = request.plane;
}

TEST(RequestPainter, ThePlanarBandIsShownBeforeItsManifoldIsBegun) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = curved_request(sweep);
  Easel easel;
  const RenderResult first = easel.answer(request);
  EXPECT_TRUE(easel.shown.empty()) << "of a sweep that is new both come together";
  move_all(request);
  const RenderResult second = easel.answer(request);
  ASSERT_EQ(easel.shown.size(), 1U);
  EXPECT_EQ(easel.shown[0].planar, second.planar);
  EXPECT_EQ(easel.shown[0].manifold, first.manifold) << "until the next is painted";
  EXPECT_NE(second.manifold, first.manifold);
  EXPECT_GT(second.manifold->version, second.planar->version);
  EXPECT_TRUE(
      same(second.planar->band, render_planar(sweep.view(), request.plane, request.settings, easel.serial)));
}

TEST(RequestPainter, WhereOnlyOneOfThemChangesNothingIsShownEarly) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = curved_request(sweep);
  Easel easel;
  easel.answer(request);
  request.plane.origin.v += request.plane.right.v;  // the curve stays
  easel.answer(request);
  EXPECT_TRUE(easel.shown.empty());
  request.reach_mm = 9;
  easel.answer(request);
  EXPECT_TRUE(easel.shown.empty());
  request.curve_mm.clear();
  move_all(request);
  EXPECT_FALSE(easel.answer(request).manifold);
  EXPECT_TRUE(easel.shown.empty());
}

TEST(RequestPainter, PicturesOfTwoSweepsAreNeverShownTogether) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = curved_request(sweep);
  Easel easel;
  easel.answer(request);
  request.sweep_version = 2;
  move_all(request);
  easel.answer(request);
  EXPECT_TRUE(easel.shown.empty());
  request.sweep_version = 3;
  request.moving = true;
  request.budget_ms = 1e-6;
  const RenderResult last = easel.answer(request);
  ASSERT_GE(easel.shown.size(), 1U);
  for (const RenderResult& r : easel.shown) {
    ASSERT_TRUE(r.manifold);
    EXPECT_LT(r.planar->version, r.manifold->version) << "begun after it, so of the same sweep";
  }
  EXPECT_FALSE(last.manifold->coarse);
}

TEST(RequestPainter, GivenUpAfterThePlanarBandItPaintsNoManifold) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = curved_request(sweep);
  Easel easel;
  const RenderResult first = easel.answer(request);
  move_all(request);
  easel.gives_up = true;
  EXPECT_FALSE(easel.answer(request).manifold);
  EXPECT_EQ(easel.shown.size(), 1U);
  // Nothing of it counts as done.
  easel.gives_up = false;
  const RenderResult again = easel.answer(request);
  EXPECT_NE(again.planar, first.planar);
  EXPECT_NE(again.manifold, first.manifold);
  EXPECT_TRUE(
      same(again.planar->band, render_planar(sweep.view(), request.plane, request.settings, easel.serial)));
}

TEST(RequestPainter, WhereTheBudgetIsTooSmallACoarsePictureComesFirstAndOnlyWhileAFingerMoves) {
  const TestSweep sweep = make_sweep();
  RenderRequest request = curved_request(sweep);
  request.budget_ms = 1e-6;
  Easel easel;
  const RenderResult first = easel.answer(request);
  EXPECT_TRUE(easel.shown.empty()) << "no finger, no coarse picture";
  EXPECT_FALSE(first.planar->coarse);
  request.moving = true;
  request.plane.origin.v += 2 * request.plane.right.v;
  request.curve_plane = request.plane;
  const RenderResult last = easel.answer(request);
  // Coarse, full, with a coarse manifold; and the answer.
  ASSERT_EQ(easel.shown.size(), 3U);
  const PlanarPicture& coarse = *easel.shown[0].planar;
  EXPECT_TRUE(coarse.coarse);
  EXPECT_FALSE(coarse.exact);
  EXPECT_EQ(coarse.plane.width, 39);
  RenderSettings every_second = request.settings;
  every_second.band = coarse_band(request.settings.band, 2);
  every_second.thin_dense_frames = true;  // as for any band under a moving finger
  EXPECT_TRUE(same(coarse.band, render_planar(sweep.view(), coarse.plane, every_second, easel.serial)));
  EXPECT_EQ(easel.shown[0].manifold, first.manifold);
  EXPECT_EQ(easel.shown[1].planar, last.planar);
  EXPECT_EQ(easel.shown[1].manifold, first.manifold);
  EXPECT_TRUE(easel.shown[2].manifold->coarse);
  EXPECT_TRUE(last.planar->exact);
  EXPECT_TRUE(
      same(last.planar->band, render_planar(sweep.view(), request.plane, request.settings, easel.serial)));
  EXPECT_FALSE(last.manifold->coarse);
}

}  // namespace
}  // namespace sonoband::test
