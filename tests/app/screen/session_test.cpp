// The session alone, without a cart, a device or a screen: what each command does to what is kept and shown.
#include "app/screen/session.h"

#include <gtest/gtest.h>

#include "tests/support/test_sweep.h"
#include "ui/interact/cross.h"

namespace sonoband::test {
namespace {

namespace c = ui::command;
using std::chrono::milliseconds;

constexpr double pixel_mm = 0.5;
constexpr int frame_count = 41;

// B-scans of 80 x 60 pixels, 1 mm apart along z.
const TestSweep& sweep() {
  static const TestSweep made = [] {
    TestSweep s;
    for (int i = 0; i < frame_count; ++i)
      s.add(80, 60, image_pose(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * i}, pixel_mm),
            [](int x, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x); });
    return s;
  }();
  return made;
}

RunSweep run_sweep(std::uint64_t id) {
  RunSweep s;
  s.held = {sweep().view(), nullptr};
  s.id = id;
  return s;
}

struct Desk {
  RenderWorker worker{1};
  Session session{worker, ui::PedalMode::hold};
  ui::View view;
  Stamp now{std::chrono::seconds(10)};

  void record(std::uint64_t id) {
    session.begin_sweep(id);
    session.grow_sweep(run_sweep(id), true);
  }
  template <class C>
  void apply(const C& command) {
    session.apply(command);
  }
  const ui::View& shown() {
    view = {};
    session.fill(view);
    return view;
  }
  void pass(Duration time) {
    for (Duration t{}; t < time; t += milliseconds(10)) session.tick(now += milliseconds(10));
  }
};

// The curve's points where they are in space, whatever plane is shown.
std::vector<Eigen::Vector3d> curve_in_world(Desk& desk) {
  const ui::View& view = desk.shown();
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : view.review.curve.line)
    points.push_back(ui::from_plane(view.review.plane, p));
  return points;
}

double farthest(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  if (a.size() != b.size() || a.empty()) return 1e9;
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

void draw_curve(Desk& desk) {
  desk.apply(c::BeginStroke{{5, 10}});
  for (int i = 1; i <= 20; ++i) desk.apply(c::ExtendStroke{{5 + 1.0 * i, 10 + 0.1 * i}});
  desk.apply(c::EndStroke{});
}

TEST(Session, ASweepIsShownOnLiveWhileItGrowsAndInReviewAtItsMiddleWhenItIsDone) {
  Desk desk;
  desk.session.begin_sweep(7);
  desk.session.grow_sweep(run_sweep(7), false);
  EXPECT_EQ(desk.shown().page, ui::Page::live);
  EXPECT_EQ(desk.session.sweep_count(), 0u);
  desk.session.tick(desk.now);
  desk.worker.wait();
  EXPECT_NE(desk.shown().live.growing.version, 0u);
  desk.session.grow_sweep(run_sweep(7), true);
  const ui::View& view = desk.shown();
  EXPECT_EQ(view.page, ui::Page::review);
  EXPECT_EQ(view.review.current, frame_count / 2);
  EXPECT_EQ(view.review.frames.size(), static_cast<std::size_t>(frame_count));
  ASSERT_EQ(view.exams.exams.size(), 1u);
  EXPECT_TRUE(view.exams.exams[0].open);
}

TEST(Session, TheBandOfTheSweepBeforeIsNotShownWithTheNext) {
  Desk desk;
  const auto painted = [&] {
    desk.pass(milliseconds(10));
    desk.worker.wait();
  };
  desk.record(1);
  painted();
  EXPECT_NE(desk.shown().review.band.version, 0u);
  desk.record(2);
  EXPECT_EQ(desk.shown().review.band.version, 0u);
  painted();
  EXPECT_NE(desk.shown().review.band.version, 0u);
  desk.session.begin_sweep(3);
  desk.session.grow_sweep(run_sweep(3), false);
  EXPECT_EQ(desk.shown().live.growing.version, 0u);
  painted();
  const std::uint64_t grown = desk.shown().live.growing.version;
  EXPECT_NE(grown, 0u);
  // Its own last band stays when it is done.
  desk.session.grow_sweep(run_sweep(3), true);
  EXPECT_EQ(desk.shown().review.band.version, grown);
}

TEST(Session, ASweepWithoutAPlaceInSpaceIsKeptAndSaysSo) {
  Desk desk;
  RunSweep empty;
  empty.id = 3;
  desk.session.begin_sweep(3);
  desk.session.grow_sweep(empty, true);
  EXPECT_EQ(desk.session.sweep_count(), 1u);
  EXPECT_NE(desk.shown().notice.find("tracker's lamp"), std::string_view::npos);
  EXPECT_EQ(desk.shown().page, ui::Page::live);
}

TEST(Session, MovesWithinThePlaneLeaveTheCurveOnTheAnatomyAndMovesOutOfItTakeItAlong) {
  Desk desk;
  desk.record(1);
  draw_curve(desk);
  const auto drawn = curve_in_world(desk);
  ASSERT_GT(drawn.size(), 10u);
  desk.apply(c::MovePlane{{3, -2}});
  desk.apply(c::TurnPlane{0.3, {10, 10}});
  desk.apply(c::ZoomPlane{1.4, {10, 10}});
  EXPECT_LT(farthest(curve_in_world(desk), drawn), 1e-9);
  // Taken along it keeps its place in the plane, where one that was left behind would be foreshortened.
  const auto before = desk.shown().review.curve.line;
  const std::vector<Eigen::Vector2d> in_plane(before.begin(), before.end());
  desk.apply(c::TiltPlane{0.2, 0.5, {10, 10}});
  const auto after = desk.shown().review.curve.line;
  ASSERT_EQ(after.size(), in_plane.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_LT((after[i] - in_plane[i]).norm(), 1e-9);
}

TEST(Session, ACurveIsUndoneAndRedone) {
  Desk desk;
  desk.record(1);
  draw_curve(desk);
  const auto drawn = curve_in_world(desk);
  desk.apply(c::ClearCurve{});
  EXPECT_TRUE(desk.shown().review.curve.line.empty());
  desk.apply(c::UndoCurve{});
  EXPECT_LT(farthest(curve_in_world(desk), drawn), 1e-12);
  EXPECT_TRUE(desk.shown().review.curve.can_redo);
  desk.apply(c::RedoCurve{});
  EXPECT_TRUE(desk.shown().review.curve.line.empty());
}

TEST(Session, DistancesAnglesAndAreasAreTheCores) {
  Desk desk;
  desk.record(1);
  desk.apply(c::AddMeasurePoint{{0, 0, 0}});
  EXPECT_FALSE(desk.shown().review.measures[0].finished);
  desk.apply(c::AddMeasurePoint{{3, 4, 0}});
  EXPECT_TRUE(desk.shown().review.measures[0].finished);
  EXPECT_DOUBLE_EQ(desk.shown().review.measures[0].value, 5);
  desk.apply(c::ChooseMeasure{ui::Measure::angle});
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 2, 0)})
    desk.apply(c::AddMeasurePoint{p});
  EXPECT_NEAR(desk.shown().review.measures[1].value, 90, 1e-9);
  desk.apply(c::ChooseMeasure{ui::Measure::area});
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(4, 0, 1), Eigen::Vector3d(4, 3, 1)})
    desk.apply(c::AddMeasurePoint{p});
  EXPECT_FALSE(desk.shown().review.measures[2].finished) << "an area has as many points as the user likes";
  desk.apply(c::FinishMeasure{});
  EXPECT_NEAR(desk.shown().review.measures[2].value, 6, 1e-9);
  desk.apply(c::AddMeasurePoint{{0, 0, 0}});
  desk.apply(c::ChooseMeasure{ui::Measure::distance});
  EXPECT_EQ(desk.shown().review.measures.size(), 3u) << "one that was begun is no other kind's";
  desk.apply(c::ClearMeasures{});
  EXPECT_TRUE(desk.shown().review.measures.empty());
}

TEST(Session, LandmarksKeepTheirNumbers) {
  Desk desk;
  desk.record(1);
  for (int i = 0; i < 3; ++i) desk.apply(c::PlaceLandmark{{1.0 * i, 0, 0}});
  desk.apply(c::RemoveLandmark{2});
  desk.apply(c::PlaceLandmark{{9, 0, 0}});
  const auto marks = desk.shown().review.landmarks;
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[1].number, 3);
  EXPECT_EQ(marks[2].number, 4);
}

// A rectangle of 2 by 1 about `corner`, and its first point again as a finger would come back to it.
void draw_contour(Desk& desk, ui::Window window, const Eigen::Vector3d& corner, const Eigen::Vector3d& right,
                  const Eigen::Vector3d& down) {
  desk.apply(c::BeginContour{corner, window});
  for (const auto& [x, y] : {std::pair{2, 0}, std::pair{2, 1}, std::pair{0, 1}})
    desk.apply(c::ExtendContour{corner + x * right + y * down});
}

TEST(Session, AContourHasTheAreaItEncloses) {
  Desk desk;
  desk.record(1);
  const TrackedFrame& f = *desk.shown().review.frames[frame_count / 2];
  const Eigen::Vector3d corner = ui::from_image(f, {10, 10});
  draw_contour(desk, ui::Window::review, corner, ui::from_image(f, {20, 10}) - corner,
               ui::from_image(f, {10, 20}) - corner);
  EXPECT_EQ(desk.shown().review.contours[0].area_mm2, 0) << "it is not closed yet";
  desk.apply(c::EndContour{});
  ASSERT_EQ(desk.shown().review.contours.size(), 1u);
  EXPECT_NEAR(desk.shown().review.contours[0].area_mm2, 20 * 10 * pixel_mm * pixel_mm, 1e-9);
  EXPECT_EQ(desk.shown().review.contours[0].frame, frame_count / 2);
  EXPECT_FALSE(desk.shown().review.contours[0].on_plane);
  const int number = desk.shown().review.contours[0].number;
  desk.apply(c::RemoveContour{number + 1});
  EXPECT_EQ(desk.shown().review.contours.size(), 1u) << "that is another one";
  desk.apply(c::RemoveContour{number});
  EXPECT_TRUE(desk.shown().review.contours.empty());
  desk.apply(c::BeginContour{corner, ui::Window::review});
  desk.apply(c::EndContour{});
  EXPECT_TRUE(desk.shown().review.contours.empty()) << "a tap encloses nothing";
}

// It stays on the anatomy as the plane moves on, and is kept with the sweep.
TEST(Session, AContourOnThePlaneStaysWhereItWasDrawn) {
  Desk desk;
  desk.record(1);
  const ReslicePlane plane = desk.shown().review.plane;
  const Eigen::Vector3d corner = ui::from_plane(plane, {5, 6});
  draw_contour(desk, ui::Window::reslice, corner, 3 * plane.right.v, 2 * plane.down.v);
  desk.apply(c::EndContour{});
  desk.apply(c::PushPlane{4});
  desk.apply(c::TurnPlane{0.3, {1, 2}});
  const ui::ReviewView& review = desk.shown().review;
  ASSERT_EQ(review.contours.size(), 1u);
  EXPECT_TRUE(review.contours[0].on_plane);
  EXPECT_LT(review.contours[0].frame, 0);
  EXPECT_NEAR(review.contours[0].area_mm2, 6 * 2, 1e-9);
  EXPECT_EQ(review.contours[0].points_world[0], corner);
  const SweepReview kept = desk.session.review_of(1);
  ASSERT_EQ(kept.contours.size(), 1u);
  ASSERT_TRUE(kept.contours[0].plane);
  EXPECT_EQ(kept.contours[0].plane->origin.v, plane.origin.v) << "the plane it was drawn on";
  desk.record(2);
  EXPECT_TRUE(desk.shown().review.contours.empty());
  ASSERT_TRUE(desk.session.show_again(1));
  ASSERT_EQ(desk.shown().review.contours.size(), 1u);
  EXPECT_NEAR(desk.shown().review.contours[0].area_mm2, 6 * 2, 1e-9);
  EXPECT_TRUE(desk.shown().review.contours[0].on_plane);
}

TEST(Session, TheCineGoesRoundAndAFlickRunsOutAtTheEnd) {
  Desk desk;
  desk.record(1);
  desk.apply(c::ShowFrame{frame_count - 1});
  desk.apply(c::Play{true});
  EXPECT_TRUE(desk.session.moving());
  desk.pass(milliseconds(400));  // at 25 a second
  EXPECT_NEAR(desk.shown().review.current, 9, 1.5);
  desk.apply(c::Play{false});
  EXPECT_FALSE(desk.session.moving());
  desk.apply(c::Fling{10000});
  desk.pass(milliseconds(200));
  EXPECT_EQ(desk.shown().review.current, frame_count - 1);
  EXPECT_FALSE(desk.session.moving());
  desk.apply(c::ShowFrame{0});
  desk.apply(c::Fling{30});
  desk.pass(std::chrono::seconds(4));
  EXPECT_FALSE(desk.session.moving());
  // What is left of a speed that halves every 0.35 s: 30 * 0.35 / ln 2.
  EXPECT_NEAR(desk.shown().review.current, 15, 1.5);
}

TEST(Session, TheShownSweepIsNeverLetGoAndADeletedOneGoesFirst) {
  Desk desk;
  for (std::uint64_t id = 1; id <= 3; ++id) desk.record(id);
  desk.apply(c::DeleteExam{2});
  EXPECT_EQ(desk.session.sweep_count(), 3u) << "it can still be taken back";
  EXPECT_TRUE(desk.session.let_go_oldest());
  EXPECT_FALSE(desk.shown().exams.can_undo_delete);
  EXPECT_TRUE(desk.session.let_go_oldest());
  EXPECT_EQ(desk.session.sweep_count(), 1u);
  EXPECT_FALSE(desk.session.let_go_oldest());
  EXPECT_EQ(desk.shown().exams.exams[0].id, 3u);
}

TEST(Session, WhatIsDeletedComesBackWhereItWas) {
  Desk desk;
  for (std::uint64_t id = 1; id <= 3; ++id) desk.record(id);
  desk.apply(c::DeleteExam{2});
  EXPECT_EQ(desk.shown().exams.exams.size(), 2u);
  EXPECT_TRUE(desk.shown().exams.can_undo_delete);
  desk.apply(c::UndoDelete{});
  const auto exams = desk.shown().exams.exams;
  ASSERT_EQ(exams.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(exams[i].id, 3 - i) << "newest first";
  desk.apply(c::UndoDelete{});
  EXPECT_EQ(desk.shown().exams.exams.size(), 3u);
}

TEST(Session, LabelsAreTypedLetterByLetterInUtf8AndEndAtALimit) {
  Desk desk;
  desk.apply(c::OpenSheet{ui::Sheet::new_exam, ui::Source::scanner});
  for (const char32_t letter : {U'M', U'ü', U'9'}) desk.apply(c::TypeLabel{letter});
  EXPECT_EQ(desk.session.typed_label(),
            "M\xc3\xbc"
            "9");
  desk.apply(c::TypeLabel{8});
  desk.apply(c::TypeLabel{8});
  EXPECT_EQ(desk.session.typed_label(), "M") << "a letter of two bytes goes as one";
  desk.apply(c::TypeLabel{U'\n'});
  EXPECT_EQ(desk.session.typed_label(), "M");
  for (int i = 0; i < 200; ++i) desk.apply(c::TypeLabel{U'x'});
  EXPECT_EQ(desk.session.typed_label().size(), 48u);
  for (int i = 0; i < 200; ++i) desk.apply(c::TypeLabel{8});
  EXPECT_EQ(desk.session.typed_label(), "");
}

TEST(Session, ANoticeStaysItsTime) {
  Desk desk;
  desk.session.say("Something.", std::chrono::seconds(2));
  desk.pass(milliseconds(1900));
  EXPECT_EQ(desk.shown().notice, "Something.");
  EXPECT_FALSE(desk.session.changed());
  desk.pass(milliseconds(200));
  EXPECT_TRUE(desk.session.changed()) << "its going is drawn";
  EXPECT_EQ(desk.shown().notice, "");
}

TEST(Session, APushMovesThePlaneByWholeLayersAndKeepsWhatIsLeft) {
  Desk desk;
  desk.record(1);
  const ReslicePlane before = desk.shown().review.plane;
  const auto moved = [&] {
    const Eigen::Vector3d by = desk.shown().review.plane.origin.v - before.origin.v;
    return by.dot(before.normal().v);
  };
  double pushed = 0;
  for (int i = 0; i < 40; ++i) {
    desk.apply(c::PushPlane{0.13});
    pushed += 0.13;
    EXPECT_NEAR(moved(), pushed, pixel_mm / 2 + 1e-9);
    EXPECT_NEAR(moved() / pixel_mm, std::round(moved() / pixel_mm), 1e-9);
  }
  desk.apply(c::PushPlane{-3});
  EXPECT_NEAR(moved(), pushed - 3, pixel_mm / 2 + 1e-9);
}

TEST(Session, AFingerThatRestsOrLeavesSeesTheBandInFull) {
  Desk desk;
  desk.record(1);
  desk.apply(c::Touching{true});
  const auto newest = [&] {
    desk.worker.wait();
    return desk.worker.newest();
  };
  for (int i = 0; i < 4; ++i) {
    desk.apply(c::PushPlane{pixel_mm});
    desk.pass(milliseconds(20));
    newest();
  }
  EXPECT_GT(desk.worker.counts().from_layers, 0U);
  EXPECT_FALSE(newest()->planar->exact);
  const std::uint64_t asked = desk.worker.counts().asked;
  desk.pass(milliseconds(200));
  EXPECT_EQ(desk.worker.counts().asked, asked + 1);
  EXPECT_TRUE(newest()->planar->exact);
  desk.pass(milliseconds(500));
  EXPECT_EQ(desk.worker.counts().asked, asked + 1) << "once";
  desk.apply(c::PushPlane{pixel_mm});
  desk.pass(milliseconds(20));
  EXPECT_FALSE(newest()->planar->exact);
  desk.apply(c::Touching{false});
  desk.pass(milliseconds(20));
  EXPECT_TRUE(newest()->planar->exact);
}

TEST(Session, AFingerOnTheStripHasLayersGotReady) {
  Desk desk;
  desk.record(1);
  desk.pass(milliseconds(20));
  desk.worker.wait();
  EXPECT_EQ(desk.worker.counts().layer_bytes, 0U);
  desk.apply(c::AboutToPush{});
  desk.pass(milliseconds(20));
  desk.worker.wait();
  EXPECT_GT(desk.worker.counts().layer_bytes, 0U);
}

TEST(Session, WithoutASweepNoCommandDoesHarm) {
  Desk desk;
  const std::vector<ui::Command> all = {c::ShowFrame{5},
                                        c::StepFrames{-3},
                                        c::Play{true},
                                        c::MovePlane{{1, 1}},
                                        c::ZoomPlane{2, {0, 0}},
                                        c::TurnPlane{1, {0, 0}},
                                        c::PushPlane{1},
                                        c::TiltPlane{1, 1, {0, 0}},
                                        c::ResetPlane{},
                                        c::ShapePlane{2},
                                        c::GrabVertex{3},
                                        c::DragVertex{3, {1, 1}},
                                        c::DropVertex{},
                                        c::UndoCurve{},
                                        c::RedoCurve{},
                                        c::FinishMeasure{},
                                        c::BeginContour{{1, 1, 1}},
                                        c::ExtendContour{{1, 1, 1}},
                                        c::EndContour{},
                                        c::RemoveContour{1},
                                        c::RemoveLandmark{4},
                                        c::OpenExam{99},
                                        c::DeleteExam{99},
                                        c::UndoDelete{},
                                        c::ScrollExams{-5},
                                        c::SelectExam{99},
                                        c::StartExport{99},
                                        c::CancelExport{},
                                        c::SetThickness{-3},
                                        c::Fling{50},
                                        c::AboutToPush{}};
  for (const ui::Command& command : all) {
    desk.session.apply(command);
    desk.pass(milliseconds(20));
    EXPECT_TRUE(desk.shown().review.frames.empty());
  }
  EXPECT_EQ(desk.worker.counts().asked, 0u);
  EXPECT_EQ(desk.shown().review.settings.band.thickness_mm, 0);
}

}  // namespace
}  // namespace sonoband::test
