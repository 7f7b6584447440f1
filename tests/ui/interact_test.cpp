// Fingers on geometry, in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/support.h"
#include "tests/support/test_sweep.h"
#include "ui/interact/cross.h"
#include "ui/interact/curve_editor.h"
#include "ui/interact/outline_view.h"
#include "ui/interact/plane_motion.h"
#include "ui/line.h"

namespace sonoband::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

ReslicePlane some_plane(std::mt19937_64& random) {
  const Eigen::Matrix3d r = random_rotation(random);
  return *make_plane({30, -20, 110}, r.col(0), r.col(1), 300, 200, 0.3);
}

// Where a fixed point of World is on the plane's picture, mm.
Vector2d seen(const ReslicePlane& plane, const Vector3d& p) {
  return ui::on_plane(plane, p).mm;
}

TEST(PlaneMotion, PictureFollowsTheFinger) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10; ++i) {
    const ReslicePlane plane = some_plane(random);
    const Vector3d p = ui::from_plane(plane, {12, 34});
    EXPECT_NEAR((seen(ui::moved(plane, {5, -3}), p) - Vector2d(17, 31)).norm(), 0, 1e-9);
  }
}

TEST(PlaneMotion, ZoomKeepsWhatIsUnderTheFingers) {
  std::mt19937_64 random(2);
  const ReslicePlane plane = some_plane(random);
  const ReslicePlane near = ui::zoomed(plane, 3, {12, 34});
  EXPECT_DOUBLE_EQ(near.pixel_mm, 0.1);
  const auto pixel = [](const ReslicePlane& p, const Vector3d& w) {
    return Vector2d(seen(p, w) / p.pixel_mm);
  };
  const Vector3d fixed = ui::from_plane(plane, {12, 34});
  EXPECT_NEAR((pixel(near, fixed) - pixel(plane, fixed)).norm(), 0, 1e-9);
  const Vector3d beside = ui::from_plane(plane, {13, 34});
  EXPECT_NEAR(pixel(near, beside).x() - pixel(near, fixed).x(), 10, 1e-9);  // 1 mm of 0.1 mm
  EXPECT_DOUBLE_EQ(ui::zoomed(plane, 1e9, {0, 0}).pixel_mm, 0.02);
  EXPECT_DOUBLE_EQ(ui::zoomed(plane, 1e-9, {0, 0}).pixel_mm, 2);
}

TEST(PlaneMotion, TurnIsClockwiseOnTheScreen) {
  std::mt19937_64 random(3);
  const ReslicePlane plane = some_plane(random);
  const ReslicePlane turned = ui::turned(plane, std::numbers::pi / 2, {10, 10});
  // What was to the right of the fingers is below them, in the same plane.
  EXPECT_NEAR((seen(turned, ui::from_plane(plane, {14, 10})) - Vector2d(10, 14)).norm(), 0, 1e-9);
  EXPECT_NEAR((turned.normal().v - plane.normal().v).norm(), 0, 1e-12);
}

TEST(PlaneMotion, PushAndTilt) {
  std::mt19937_64 random(4);
  const ReslicePlane plane = some_plane(random);
  EXPECT_NEAR(ui::on_plane(plane, ui::pushed(plane, 2.5).origin.v).off_mm, 2.5, 1e-9);
  const Vector2d middle(40, 25);
  const Vector3d fixed = ui::from_plane(plane, middle);
  const ReslicePlane tilted = ui::tilted(plane, 0.3, 0, middle);
  EXPECT_NEAR((seen(tilted, fixed) - middle).norm(), 0, 1e-9);
  EXPECT_NEAR(ui::on_plane(tilted, fixed).off_mm, 0, 1e-9);
  EXPECT_NEAR(tilted.normal().v.dot(plane.normal().v), std::cos(0.3), 1e-12);
  EXPECT_NEAR(tilted.right.v.dot(plane.right.v), 1, 1e-12);
}

TEST(PlaneMotion, AxesStaySquareAfterManySteps) {
  std::mt19937_64 random(5);
  ReslicePlane plane = some_plane(random);
  std::uniform_real_distribution<double> step(-0.05, 0.05);
  for (int i = 0; i < 5000; ++i) {
    plane = ui::turned(ui::tilted(plane, step(random), step(random), {30, 20}), step(random), {5, 5});
  }
  EXPECT_NEAR(plane.right.v.norm(), 1, 1e-12);
  EXPECT_NEAR(plane.down.v.norm(), 1, 1e-12);
  EXPECT_NEAR(plane.right.v.dot(plane.down.v), 0, 1e-12);
}

TestSweep sweep_of(int frames) {
  TestSweep sweep;
  for (int i = 0; i < frames; ++i) {
    sweep.add(100, 80, image_pose(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(i)}, 0.5),
              [](int, int, const Vector3d&) { return std::uint8_t{50}; });
  }
  return sweep;
}

TEST(Crossing, OfABScanAndALevelPlane) {
  TestSweep sweep = sweep_of(1);
  const TrackedFrame& f = *sweep.frames()[0];
  // The plane y = 10 mm: row 20 of the picture, from edge to edge.
  const ReslicePlane level = *make_plane({0, 10, -5}, Vector3d::UnitZ(), Vector3d::UnitX(), 50, 50, 1);
  const auto cross = ui::crossing(f, level);
  ASSERT_TRUE(cross);
  EXPECT_NEAR(cross->image_px[0].y(), 20, 1e-9);
  EXPECT_NEAR(cross->image_px[1].y(), 20, 1e-9);
  EXPECT_NEAR(std::abs(cross->image_px[1].x() - cross->image_px[0].x()), 100, 1e-9);
  EXPECT_NEAR(cross->plane_mm[0].x(), 5, 1e-9);  // the B-scan stands at z = 0, 5 mm along the plane's right
  EXPECT_NEAR(cross->plane_mm[1].x(), 5, 1e-9);
  const ReslicePlane beside = *make_plane({0, 200, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), 50, 50, 1);
  EXPECT_FALSE(ui::crossing(f, beside));
  const ReslicePlane parallel = *make_plane({0, 0, 3}, Vector3d::UnitX(), Vector3d::UnitY(), 50, 50, 1);
  EXPECT_FALSE(ui::crossing(f, parallel));
}

TEST(Crossing, EndsLieInBothPictures) {
  std::mt19937_64 random(6);
  TestSweep sweep = sweep_of(1);
  const TrackedFrame& f = *sweep.frames()[0];
  int crossed = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d r = random_rotation(random);
    const ReslicePlane plane = *make_plane({10, 15, 5}, r.col(0), r.col(1), 50, 50, 1);
    const auto cross = ui::crossing(f, plane);
    if (!cross) continue;
    ++crossed;
    for (int end = 0; end < 2; ++end) {
      const Vector3d p = ui::from_image(f, cross->image_px[end]);
      EXPECT_NEAR(ui::on_plane(plane, p).off_mm, 0, 1e-8);
      EXPECT_NEAR((ui::from_plane(plane, cross->plane_mm[end]) - p).norm(), 0, 1e-8);
      EXPECT_GE(cross->image_px[end].x(), -0.5 - 1e-9);
      EXPECT_LE(cross->image_px[end].x(), 99.5 + 1e-9);
    }
  }
  EXPECT_GT(crossed, 100);
}

TEST(Outline, PicksTheArchUnderTheFinger) {
  TestSweep sweep = sweep_of(40);
  const SweepView view = sweep.view();
  const ui::Rect window{100, 50, 600, 400};
  const ui::OutlineView eye(ui::frame_of(view.frames), ui::Orbit{0.3, 0.5, 1, {0, 0}}, window);
  for (const int i : {0, 17, 39}) {
    // The middle of the skin edge.
    const auto corners = ui::corners_of(*view.frames[i]);
    const auto found = ui::pick_outline(view.frames, eye, eye.at(0.5 * (corners[0] + corners[1])), 20);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, i, 1);
  }
  EXPECT_FALSE(ui::pick_outline(view.frames, eye, {102, 52}, 20));
}

// 400 B-scans that take some 250 pixels of the window.
TEST(Outline, OutlinesThatLieDenserThanTheWindowShowsAreLeftOut) {
  TestSweep sweep = sweep_of(400);
  const SweepView view = sweep.view();
  const ui::OutlineView eye(ui::frame_of(view.frames), ui::Orbit{0.3, 0.5, 1, {0, 0}}, {0, 0, 300, 300});
  const auto moved = [&](int a, int b) {
    const auto from = ui::corners_of(*view.frames[a]), to = ui::corners_of(*view.frames[b]);
    float most = 0;
    for (std::size_t k = 0; k < 4; ++k) most = std::max(most, length(eye.at(from[k]) - eye.at(to[k])));
    return most;
  };
  std::vector<int> shown = {7, 7, 7};
  ui::outlines_apart(view.frames, eye, 2, shown);
  ASSERT_GE(shown.size(), 3u);
  EXPECT_LT(shown.size(), 200u);
  EXPECT_EQ(shown.front(), 0);
  EXPECT_EQ(shown.back(), 399);
  for (std::size_t i = 1; i < shown.size(); ++i) {
    if (i + 1 < shown.size()) {
      EXPECT_GE(moved(shown[i - 1], shown[i]), 2);
    }
    for (int left_out = shown[i - 1] + 1; left_out < shown[i]; ++left_out)
      EXPECT_LT(moved(shown[i - 1], left_out), 2);
  }
  ui::outlines_apart(view.frames, eye, 0, shown);
  EXPECT_EQ(shown.size(), 400u);
  ui::outlines_apart(view.frames.first(1), eye, 2, shown);
  EXPECT_EQ(shown, std::vector<int>{0});
  ui::outlines_apart({}, eye, 2, shown);
  EXPECT_TRUE(shown.empty());
}

TEST(Outline, EyeIsRightHandedAndKeepsLengths) {
  TestSweep sweep = sweep_of(10);
  for (const double turn : {-1.0, 0.0, 2.0}) {
    const ui::OutlineView eye(ui::frame_of(sweep.view().frames), ui::Orbit{turn, 0.7, 1, {0, 0}},
                              {0, 0, 300, 300});
    EXPECT_NEAR(eye.eye_from_world().determinant(), 1, 1e-12);
    EXPECT_NEAR(
        (eye.eye_from_world() * eye.eye_from_world().transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
        1e-12);
    // From above the skin, what is deeper is lower on the screen.
    EXPECT_GT(eye.at({10, 30, 5}).y, eye.at({10, 0, 5}).y);
  }
}

TEST(CurveEditor, StraightStrokeStaysStraight) {
  ui::CurveEditor editor(0.4);
  editor.begin({0, 10});
  for (int i = 1; i <= 50; ++i) editor.extend({static_cast<double>(i), 10});
  EXPECT_TRUE(editor.drawing());
  editor.end();
  ASSERT_GT(editor.line().size(), 100u);
  for (const Vector2d& p : editor.line()) EXPECT_NEAR(p.y(), 10, 1e-9);
  EXPECT_NEAR(editor.line().front().x(), 0, 1e-9);
  EXPECT_NEAR(editor.line().back().x(), 50, 1e-9);
  EXPECT_GE(editor.handles().size(), 3u);
}

TEST(CurveEditor, SmoothsTheJitterOfAHand) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> jitter(0, 0.25);
  ui::CurveEditor editor(0.4);
  editor.begin({0, 0});
  for (int i = 1; i <= 200; ++i) editor.extend({i * 0.3, jitter(random)});
  editor.end();
  double worst = 0;
  for (const Vector2d& p : editor.line()) worst = std::max(worst, std::abs(p.y()));
  EXPECT_LT(worst, 0.35);
}

TEST(CurveEditor, DragMovesTheHandleAndNothingBeyondItsNeighbours) {
  ui::CurveEditor editor(0.4);
  editor.begin({0, 0});
  editor.extend({60, 0});
  editor.end();
  const std::vector<Vector2d> before = editor.handles();
  ASSERT_GE(before.size(), 5u);
  editor.grab(2);
  editor.drag({before[2].x() + 1, 7});
  editor.drop();
  EXPECT_NEAR((editor.handles()[2] - Vector2d(before[2].x() + 1, 7)).norm(), 0, 1e-9);
  for (const std::size_t i : {0u, 1u, 3u, 4u}) EXPECT_NEAR((editor.handles()[i] - before[i]).norm(), 0, 1e-9);
}

TEST(CurveEditor, UndoAndRedoGoThroughEveryStep) {
  ui::CurveEditor editor(0.4);
  const auto stroke = [&](double y) {
    editor.begin({0, y});
    editor.extend({30, y});
    editor.end();
  };
  stroke(1);
  stroke(2);
  editor.grab(1);
  editor.drag({15, 9});
  editor.drop();
  editor.clear();
  EXPECT_TRUE(editor.line().empty());
  editor.undo();
  EXPECT_NEAR(editor.handles()[1].y(), 9, 1e-9);
  editor.undo();
  EXPECT_NEAR(editor.handles()[1].y(), 2, 1e-9);
  editor.undo();
  EXPECT_NEAR(editor.handles()[1].y(), 1, 1e-9);
  editor.undo();
  EXPECT_TRUE(editor.line().empty());
  EXPECT_FALSE(editor.can_undo());
  for (int i = 0; i < 3; ++i) editor.redo();
  EXPECT_NEAR(editor.handles()[1].y(), 9, 1e-9);
  stroke(5);
  EXPECT_FALSE(editor.can_redo());
}

TEST(CurveEditor, ASlipOfTheFingerDrawsNothing) {
  ui::CurveEditor editor(0.4);
  editor.begin({0, 0});
  editor.extend({30, 0});
  editor.end();
  editor.begin({5, 5});
  editor.extend({6, 6});
  editor.end();
  EXPECT_NEAR(editor.line().back().x(), 30, 1e-9);
  editor.undo();
  EXPECT_TRUE(editor.line().empty());
}

TEST(Words, NumbersAndPatterns) {
  using namespace ui;  // NOLINT: the names under test
  EXPECT_EQ(Line("{0} of {1}", {count(3), count(3412)}).view(), "3 of 3\u2009412");
  EXPECT_EQ(Line("{1} {0}", {"a", "b"}).view(), "b a");
  EXPECT_EQ(Line("{0} mm", {number(-0.04, 1)}).view(), "0.0 mm");
  EXPECT_EQ(Line("{0}", {number(std::nan(""), 1)}).view(), "–");
  EXPECT_EQ(Line("{0}", {clock_time(66.44)}).view(), "01:06.4");
  EXPECT_EQ(Line("100 {", {}).view(), "100 ");
  std::string longer(300, 'x');
  longer.replace(250, 10, "ééééé");
  EXPECT_LE(Line(longer, {}).view().size(), 256u);
}

}  // namespace
}  // namespace sonoband::test
