// Every widget by its name: which command a tap on it asks for, on every page and every sheet.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/ui/showcase.h"
#include "ui/interact/cross.h"

namespace sonoband::test {
namespace {

namespace c = ui::command;

// Of the alternative C of Command.
template <class C>
std::size_t index_of() {
  return ui::Command(C{}).index();
}

struct Tapped {
  const char* widget;
  std::size_t asks;
};

ui::View review_with(ui::Tool tool) {
  ui::View view = review_view();
  view.review.tool = tool;
  view.review.curve.can_redo = true;
  static const std::array<Eigen::Vector3d, 2> points = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5, 0, 0)};
  static const std::array<ui::MeasureView, 1> measures = {{{ui::Measure::area, points, 0, false}}};
  view.review.measures = measures;
  view.review.measure = ui::Measure::area;
  static const std::array<Eigen::Vector3d, 3> outline = {ui::from_image(*view.review.frames[36], {10, 10}),
                                                         ui::from_image(*view.review.frames[36], {60, 10}),
                                                         ui::from_image(*view.review.frames[36], {60, 70})};
  static const std::array<ui::ContourView, 1> contours = {{{1, 36, false, outline, true, 40}}};
  view.review.contours = contours;
  return view;
}

ui::View with_sheet(ui::Sheet sheet) {
  ui::View view = exams_view();
  view.sheet = sheet;
  return view;
}

void expect_each(const ui::View& view, std::initializer_list<Tapped> all) {
  for (const Tapped& t : all) {
    Bench bench;
    bench.frame(view);
    ASSERT_TRUE(bench.screen->widgets().find(t.widget)) << t.widget;
    std::vector<ui::Command> commands = bench.tap(view, t.widget);
    const bool asked = std::any_of(commands.begin(), commands.end(),
                                   [&](const ui::Command& command) { return command.index() == t.asks; });
    EXPECT_TRUE(asked) << t.widget;
  }
}

TEST(EveryWidget, OfTheFrame) {
  expect_each(live_view(), {{"rail/live", index_of<c::GoTo>()},
                            {"rail/review", index_of<c::GoTo>()},
                            {"rail/exams", index_of<c::GoTo>()},
                            {"rail/set-up", index_of<c::GoTo>()},
                            {"rail/help", index_of<c::OpenSheet>()},
                            {"rail/snapshot", index_of<c::Snapshot>()},
                            {"status/scanner", index_of<c::OpenSheet>()},
                            {"status/tracker", index_of<c::OpenSheet>()},
                            {"status/pedal", index_of<c::OpenSheet>()},
                            {"status/storage", index_of<c::OpenSheet>()},
                            {"status/ring", index_of<c::OpenSheet>()},
                            {"status/lost", index_of<c::OpenSheet>()},
                            {"live/record", index_of<c::Pedal>()}});
}

TEST(EveryWidget, OfReview) {
  expect_each(review_view(), {{"review/title", index_of<c::FillPage>()},
                              {"reslice/title", index_of<c::FillPage>()},
                              {"manifold/title", index_of<c::FillPage>()},
                              {"outline/title", index_of<c::FillPage>()},
                              {"review/play", index_of<c::Play>()},
                              {"review/slider", index_of<c::ShowFrame>()},
                              {"tools/maximum", index_of<c::ChooseCompounding>()},
                              {"tools/minimum", index_of<c::ChooseCompounding>()},
                              {"tools/mean", index_of<c::ChooseCompounding>()},
                              {"tools/nearest", index_of<c::ChooseInterpolation>()},
                              {"tools/linear", index_of<c::ChooseInterpolation>()},
                              {"tools/thickness", index_of<c::SetThickness>()},
                              {"tools/picture", index_of<c::OpenSheet>()},
                              {"tools/move", index_of<c::ChooseTool>()},
                              {"tools/curve", index_of<c::ChooseTool>()},
                              {"tools/mark", index_of<c::ChooseTool>()},
                              {"tools/measure", index_of<c::ChooseTool>()},
                              {"tools/contour", index_of<c::ChooseTool>()},
                              {"tools/reset", index_of<c::ResetPlane>()}});
  expect_each(review_with(ui::Tool::curve), {{"curve/clear", index_of<c::ClearCurve>()},
                                             {"curve/undo", index_of<c::UndoCurve>()},
                                             {"curve/redo", index_of<c::RedoCurve>()}});
  expect_each(review_with(ui::Tool::landmark), {{"review/picture", index_of<c::PlaceLandmark>()},
                                                {"reslice/picture", index_of<c::PlaceLandmark>()}});
  expect_each(review_with(ui::Tool::measure), {{"review/picture", index_of<c::AddMeasurePoint>()},
                                               {"reslice/picture", index_of<c::AddMeasurePoint>()},
                                               {"measure/clear", index_of<c::ClearMeasures>()},
                                               {"measure/done", index_of<c::FinishMeasure>()},
                                               {"measure/distance", index_of<c::ChooseMeasure>()},
                                               {"measure/angle", index_of<c::ChooseMeasure>()},
                                               {"measure/area", index_of<c::ChooseMeasure>()}});
  expect_each(review_with(ui::Tool::contour), {{"contour/clear", index_of<c::RemoveContour>()}});
}

// In both windows a finger draws round a structure, and one that stays on a contour takes that one away.
TEST(EveryWidget, OfTheContourTool) {
  const ui::View view = review_with(ui::Tool::contour);
  Bench bench;
  bench.frame(view);
  for (const auto& [name, window] :
       {std::pair{"review/picture", ui::Window::review}, std::pair{"reslice/picture", ui::Window::reslice}}) {
    const ui::Vec2 middle = bench.find(name).centre();
    const std::vector<ui::Command> asked = bench.drag(view, middle, middle + ui::Vec2{30, 40});
    const auto begun = only<c::BeginContour>(asked);
    ASSERT_EQ(begun.size(), 1u) << name;
    EXPECT_EQ(begun[0].window, window);
    const auto on_the_way = only<c::ExtendContour>(asked);
    ASSERT_FALSE(on_the_way.empty());
    EXPECT_EQ(only<c::EndContour>(asked).size(), 1u);
    EXPECT_TRUE(only<c::MovePlane>(asked).empty());
    // Where the finger was, in space.
    for (const Eigen::Vector3d& p : {begun[0].at_world, on_the_way.back().to_world}) {
      const double off = window == ui::Window::reslice ? ui::on_plane(view.review.plane, p).off_mm
                                                       : ui::on_image(*view.review.frames[36], p).off_mm;
      EXPECT_NEAR(off, 0, 1e-6) << name;
    }
  }
}

TEST(EveryWidget, OfReviewThatIsDragged) {
  const ui::View view = review_view();
  Bench bench;
  bench.frame(view);
  const auto dragged = [&](const char* name) {
    const ui::Vec2 middle = bench.find(name).centre();
    return bench.drag(view, middle, middle + ui::Vec2{3, 40});
  };
  EXPECT_FALSE(only<c::MovePlane>(dragged("reslice/picture")).empty());
  EXPECT_FALSE(only<c::PushPlane>(dragged("reslice/normal")).empty());
  EXPECT_FALSE(only<c::TiltPlane>(dragged("reslice/trackball")).empty());
  EXPECT_FALSE(only<c::SetReach>(dragged("manifold/reach")).empty());
  EXPECT_FALSE(only<c::SetOrbit>(dragged("outline/picture")).empty());
}

TEST(EveryWidget, OfExamsSetUpAndTheSheets) {
  ui::View exams = exams_view();
  exams.exams.can_undo_delete = true;
  expect_each(exams, {{"exams/0", index_of<c::SelectExam>()},
                      {"exams/4", index_of<c::SelectExam>()},
                      {"exams/new", index_of<c::OpenSheet>()},
                      {"exams/open", index_of<c::OpenExam>()},
                      {"exams/export", index_of<c::OpenSheet>()},
                      {"exams/delete", index_of<c::DeleteExam>()},
                      {"exams/undo", index_of<c::UndoDelete>()}});
  expect_each(set_up_view(), {{"set-up/hold", index_of<c::ChoosePedalMode>()},
                              {"set-up/toggle", index_of<c::ChoosePedalMode>()}});
  for (const ui::Sheet sheet : {ui::Sheet::losses, ui::Sheet::source, ui::Sheet::picture, ui::Sheet::help,
                                ui::Sheet::new_exam, ui::Sheet::export_exam})
    expect_each(with_sheet(sheet), {{"sheet/close", index_of<c::OpenSheet>()}});
  expect_each(with_sheet(ui::Sheet::new_exam), {{"key/Q", index_of<c::TypeLabel>()},
                                                {"key/space", index_of<c::TypeLabel>()},
                                                {"key/backspace", index_of<c::TypeLabel>()},
                                                {"new-exam/cancel", index_of<c::OpenSheet>()},
                                                {"new-exam/start", index_of<c::NewExam>()}});
  ui::View choosing = with_sheet(ui::Sheet::export_exam);
  choosing.exams.transfer.choice.format = ui::ExportAs::dicom;  // which has a place for the label
  expect_each(choosing, {{"export/mha", index_of<c::ChooseExport>()},
                         {"export/nrrd", index_of<c::ChooseExport>()},
                         {"export/sx", index_of<c::ChooseExport>()},
                         {"export/sw", index_of<c::ChooseExport>()},
                         {"export/dicom", index_of<c::ChooseExport>()},
                         {"export/png", index_of<c::ChooseExport>()},
                         {"export/webm", index_of<c::ChooseExport>()},
                         {"export/marks", index_of<c::ChooseExport>()},
                         {"export/place-0", index_of<c::ChooseExport>()},
                         {"export/place-1", index_of<c::ChooseExport>()},
                         {"export/one-sweep", index_of<c::ChooseExport>()},
                         {"export/all-sweeps", index_of<c::ChooseExport>()},
                         {"export/label", index_of<c::ChooseExport>()},
                         {"export/remove", index_of<c::RemoveSafely>()},
                         {"export/start", index_of<c::StartExport>()}});
  ui::View running = with_sheet(ui::Sheet::export_exam);
  running.exams.transfer.phase = ui::ExportPhase::exporting;
  expect_each(running, {{"export/cancel", index_of<c::CancelExport>()}});
  ui::View picture = with_sheet(ui::Sheet::picture);
  picture.review.look.gain = 0.3f;  // so that the middle of the groove is another value
  expect_each(picture, {{"picture/gain", index_of<c::SetLook>()},
                        {"picture/contrast", index_of<c::SetLook>()},
                        {"picture/smooth-off", index_of<c::SetLook>()}});
}

// A script that names a widget must find that one and no other.
TEST(EveryWidget, HasANameOfItsOwnThatIsNotCut) {
  std::vector<ui::View> views = {live_view(), recording_view(), exams_view(), set_up_view()};
  for (const ui::Tool tool :
       {ui::Tool::move, ui::Tool::curve, ui::Tool::landmark, ui::Tool::measure, ui::Tool::contour})
    views.push_back(review_with(tool));
  for (const ui::Sheet sheet : {ui::Sheet::losses, ui::Sheet::source, ui::Sheet::picture, ui::Sheet::help,
                                ui::Sheet::new_exam, ui::Sheet::export_exam, ui::Sheet::recovering})
    views.push_back(with_sheet(sheet));
  Bench bench;
  for (const ui::View& view : views) {
    bench.frame(view);
    std::set<std::string> names;
    for (const ui::Widget& w : bench.screen->widgets().all()) {
      const std::string name = w.name.data();
      EXPECT_FALSE(name.empty());
      EXPECT_LT(name.size(), w.name.size() - 1) << name;
      EXPECT_EQ(w.id, ui::id_of(name)) << name;
      EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
    }
    EXPECT_GT(names.size(), 8u);
  }
}

}  // namespace
}  // namespace sonoband::test
