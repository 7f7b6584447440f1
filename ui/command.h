// What the screen asks for: one queue of values, the only arrow back.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <variant>
#include <vector>

#include "ui/view.h"

namespace sonoband::ui {

namespace command {

struct Pedal {  // the key or the button that stands in for the footswitch
  bool down = false;
};
struct GoTo {
  Page page = Page::live;
};
struct OpenSheet {  // Sheet::none closes
  Sheet sheet = Sheet::none;
  Source source = Source::scanner;
};
struct ToggleFullScreen {};  // of the window on the desktop
struct Quit {};

// Review window
struct ShowFrame {
  std::int32_t index = 0;
};
struct StepFrames {
  std::int32_t by = 0;
};
struct Play {
  bool on = false;
};
struct Fling {  // through the B-scans, slowing down
  double frames_per_s = 0;
};

// Reslice window. Lengths in mm of the plane, x right and y down from the centre of pixel (0,0).
struct MovePlane {  // the picture follows the finger: the plane moves the other way
  Eigen::Vector2d by_mm;
};
struct ZoomPlane {  // greater than 1: nearer
  double factor = 1;
  Eigen::Vector2d about_mm;
};
struct TurnPlane {  // the picture turns clockwise
  double by_rad = 0;
  Eigen::Vector2d about_mm;
};
struct PushPlane {  // along its normal
  double by_mm = 0;
};
struct TiltPlane {  // about its own right and down axes through `about_mm`
  double about_right_rad = 0;
  double about_down_rad = 0;
  Eigen::Vector2d about_mm;
};
struct AboutToPush {};  // a finger has landed on what pushes the plane or makes the band thicker
struct ResetPlane {};
struct ShapePlane {  // so that the picture fills its window
  double width_per_height = 1;
};
// A finger is on a window that renders, so a slow machine may show less; false: it has left.
struct Touching {
  bool on = false;
};

// Curve
struct BeginStroke {
  Eigen::Vector2d at_mm;
};
struct ExtendStroke {
  Eigen::Vector2d to_mm;
};
struct EndStroke {};
struct GrabVertex {
  int index = 0;
};
struct DragVertex {
  int index = 0;
  Eigen::Vector2d to_mm;
};
struct DropVertex {};
struct ClearCurve {};
struct UndoCurve {};
struct RedoCurve {};
struct SetReach {
  double mm = 0;
};

// Marks. Points in World.
struct PlaceLandmark {
  Eigen::Vector3d at_world;
};
struct RemoveLandmark {
  int number = 0;
};
struct AddMeasurePoint {
  Eigen::Vector3d at_world;
};
struct FinishMeasure {};
struct ClearMeasures {};
struct ChooseMeasure {
  Measure kind = Measure::distance;
};
struct BeginContour {
  Eigen::Vector3d at_world;
  Window window = Window::review;  // on the B-scan shown, or (reslice) on the plane
};
struct ExtendContour {
  Eigen::Vector3d to_world;
};
struct EndContour {};
struct RemoveContour {
  int number = 0;
};

// What is shown, and how
struct ChooseTool {
  Tool tool = Tool::move;
};
struct SetThickness {
  double mm = 0;
};
struct ChooseCompounding {
  Compounding compounding = Compounding::maximum;
};
struct ChooseInterpolation {
  Interpolation interpolation = Interpolation::nearest;
};
struct SetLook {
  Look look;
};
struct FillPage {
  Window window = Window::none;
};
struct SetOrbit {
  Orbit orbit;
};
struct Snapshot {
  Window window = Window::none;  // none: the whole screen
};

// Exams
struct SelectExam {
  std::uint64_t id = 0;
};
struct OpenExam {
  std::uint64_t id = 0;
};
struct ChooseSweep {  // of the exam selected
  int by = 0;
};
struct NewExam {};  // with the label typed
struct TypeLabel {
  char32_t character = 0;  // 8: take the last one away
};
struct DeleteExam {
  std::uint64_t id = 0;
};
struct UndoDelete {};
struct ScrollExams {
  int by = 0;
};
struct ChooseExport {
  ExportChoice choice;
};
struct StartExport {
  std::uint64_t id = 0;
};
struct CancelExport {};
struct RemoveSafely {
  int place = 0;  // index into ExportView::places
};

// Set-up
struct ChooseProbe {
  int index = 0;
};
struct ChoosePedalMode {
  PedalMode mode = PedalMode::hold;
};
struct SetSound {
  bool on = true;
};

}  // namespace command

using Command = std::variant<
    command::Pedal, command::GoTo, command::OpenSheet, command::ToggleFullScreen, command::Quit,
    command::ShowFrame, command::StepFrames, command::Play, command::Fling, command::MovePlane,
    command::ZoomPlane, command::TurnPlane, command::PushPlane, command::TiltPlane, command::ResetPlane,
    command::ShapePlane, command::Touching, command::AboutToPush, command::BeginStroke, command::ExtendStroke,
    command::EndStroke, command::GrabVertex, command::DragVertex, command::DropVertex, command::ClearCurve,
    command::UndoCurve, command::RedoCurve, command::SetReach, command::PlaceLandmark,
    command::RemoveLandmark, command::AddMeasurePoint, command::FinishMeasure, command::ClearMeasures,
    command::ChooseMeasure, command::BeginContour, command::ExtendContour, command::EndContour,
    command::RemoveContour, command::ChooseTool, command::SetThickness, command::ChooseCompounding,
    command::ChooseInterpolation, command::SetLook, command::FillPage, command::SetOrbit, command::Snapshot,
    command::SelectExam, command::OpenExam, command::ChooseSweep, command::NewExam, command::TypeLabel,
    command::DeleteExam, command::UndoDelete, command::ScrollExams, command::ChooseExport,
    command::StartExport, command::CancelExport, command::RemoveSafely, command::ChooseProbe,
    command::ChoosePedalMode, command::SetSound>;

using Commands = std::vector<Command>;

}  // namespace sonoband::ui
