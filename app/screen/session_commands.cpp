// What each command does to the session.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "app/screen/session.h"
#include "core/review/measure.h"
#include "ui/interact/plane_motion.h"

namespace sonoband {
namespace {

constexpr double least_reach_mm = 2;
constexpr double most_reach_mm = 120;
constexpr std::size_t longest_label = 48;

// The commands that only replace one value are carried out here; one function for each of the others.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

// Not what only moves what is shown, and not what the windows' shape makes of the plane.
bool changes_review(const ui::Command& command) {
  namespace c = ui::command;
  return std::visit(
      []<class C>(const C&) {
        return std::disjunction_v<
            std::is_same<C, c::MovePlane>, std::is_same<C, c::ZoomPlane>, std::is_same<C, c::TurnPlane>,
            std::is_same<C, c::PushPlane>, std::is_same<C, c::TiltPlane>, std::is_same<C, c::ResetPlane>,
            std::is_same<C, c::EndStroke>, std::is_same<C, c::DragVertex>, std::is_same<C, c::DropVertex>,
            std::is_same<C, c::ClearCurve>, std::is_same<C, c::UndoCurve>, std::is_same<C, c::RedoCurve>,
            std::is_same<C, c::SetReach>, std::is_same<C, c::PlaceLandmark>,
            std::is_same<C, c::RemoveLandmark>, std::is_same<C, c::AddMeasurePoint>,
            std::is_same<C, c::FinishMeasure>, std::is_same<C, c::ClearMeasures>,
            std::is_same<C, c::EndContour>, std::is_same<C, c::RemoveContour>,
            std::is_same<C, c::SetThickness>, std::is_same<C, c::ChooseCompounding>,
            std::is_same<C, c::ChooseInterpolation>>;
      },
      command);
}

}  // namespace

void Session::add_measure_point(const Eigen::Vector3d& p) {
  if (measures_.empty() || measures_.back().finished)
    measures_.push_back({measure_, {}, false, next_mark_++});
  MeasureItem& m = measures_.back();
  m.points.push_back(p);
  const std::size_t needs = m.kind == ui::Measure::distance ? 2 : 3;
  if (m.kind != ui::Measure::area && m.points.size() == needs) m.finished = true;
}

void Session::contour(const ui::Command& command) {
  namespace c = ui::command;
  if (const auto* begin = std::get_if<c::BeginContour>(&command)) {
    if (frame_count() == 0) return;
    const bool on_plane = begin->window == ui::Window::reslice;
    ContourItem item;
    item.frame = on_plane ? -1 : static_cast<std::int32_t>(current_);
    if (on_plane) item.plane = plane_;
    item.points = {begin->at_world};
    item.number = next_mark_++;
    contours_.push_back(std::move(item));
  } else if (const auto* extend = std::get_if<c::ExtendContour>(&command)) {
    if (contours_.empty() || contours_.back().finished) return;
    // A point a pixel from the last adds nothing but work.
    if ((extend->to_world - contours_.back().points.back()).norm() >= settings_.band.step_mm)
      contours_.back().points.push_back(extend->to_world);
  } else if (std::holds_alternative<c::EndContour>(command)) {
    if (contours_.empty() || contours_.back().finished) return;
    ContourItem& item = contours_.back();
    item.finished = true;
    if (item.points.size() < 3 || item.frame >= frame_count()) return contours_.pop_back();
    if (!item.plane) item.captured = shown()->held.view.frames[item.frame]->captured;
    item.area_mm2 = sonoband::area_mm2(item.points);
  } else if (const auto* gone = std::get_if<c::RemoveContour>(&command)) {
    std::erase_if(contours_, [&](const ContourItem& item) { return item.number == gone->number; });
  }
}

void Session::apply(const ui::Command& command) {
  namespace c = ui::command;
  changed_ = true;
  if (changes_review(command)) {
    review_changed_ = true;
    review_rests_.reset();
  }
  const auto last = static_cast<double>(std::max(0, frame_count() - 1));
  const auto show_frame = [&](double index) {
    current_ = std::clamp(index, 0.0, last);
    fling_ = 0;
  };
  const auto move = [&](const ReslicePlane& plane) {
    if (frame_count() == 0) return;
    plane_chosen_ = true;
    plane_ = plane;
    dirty_ = true;
  };
  const auto move_out = [&](const ReslicePlane& plane) {
    if (frame_count() > 0) curve_plane_ = ui::carried(curve_plane_, plane_, plane);
    move(plane);
  };
  // By whole layers of the band, so that those painted before serve again.
  const auto push = [&](double mm) {
    const double step = settings_.band.step_mm;
    if (frame_count() == 0 || !(step > 0)) return;
    push_rest_mm_ += mm;
    const double whole = std::round(push_rest_mm_ / step) * step;
    push_rest_mm_ -= whole;
    if (whole != 0) move_out(ui::pushed(plane_, whole));
  };
  const auto curved = [&](auto&& change) {
    const std::uint64_t before = curve_.version();
    change();
    if (curve_.version() != before) dirty_ = true;
  };
  std::visit(
      Overloaded{
          [&](const c::GoTo& to) {
            page_ = to.page;
            sheet_ = ui::Sheet::none;
          },
          [&](const c::OpenSheet& open) {
            sheet_ = open.sheet;
            sheet_source_ = open.source;
            if (open.sheet == ui::Sheet::new_exam) new_label_.clear();
          },
          [&](const c::ShowFrame& to) { show_frame(to.index); },
          [&](const c::StepFrames& step) { show_frame(std::floor(current_) + step.by); },
          [&](const c::Play& play) { playing_ = play.on && frame_count() > 1; },
          [&](const c::Fling& fling) { fling_ = fling.frames_per_s; },
          [&](const c::MovePlane& by) { move(ui::moved(plane_, by.by_mm)); },
          [&](const c::ZoomPlane& by) { move(ui::zoomed(plane_, by.factor, by.about_mm)); },
          [&](const c::TurnPlane& by) { move(ui::turned(plane_, by.by_rad, by.about_mm)); },
          [&](const c::PushPlane& by) { push(by.by_mm); },
          [&](const c::AboutToPush&) {
            push_ahead_ = true;
            dirty_ = true;
          },
          [&](const c::TiltPlane& by) {
            move_out(ui::tilted(plane_, by.about_right_rad, by.about_down_rad, by.about_mm));
          },
          [&](const c::ResetPlane&) {
            plane_chosen_ = false;
            reset_plane();
          },
          [&](const c::ShapePlane& to) {
            width_per_height_ = std::clamp(to.width_per_height, 0.2, 5.0);
            if (frame_count() > 0) shape_plane();
          },
          [&](const c::Touching& touching) {
            if (touching_ && !touching.on) dirty_ = true;  // once more, in full
            touching_ = touching.on;
          },
          [&](const c::BeginStroke& s) {
            if (curve_.line().empty() && !curve_.can_undo() && !curve_.can_redo()) {
              curve_plane_ = plane_;
              curve_plane_.pixel_mm = settings_.band.step_mm;
            }
            curved([&] { curve_.begin(to_curve(s.at_mm)); });
          },
          [&](const c::ExtendStroke& s) { curved([&] { curve_.extend(to_curve(s.to_mm)); }); },
          [&](const c::EndStroke&) { curved([&] { curve_.end(); }); },
          [&](const c::GrabVertex& g) { curve_.grab(g.index); },
          [&](const c::DragVertex& d) { curved([&] { curve_.drag(to_curve(d.to_mm)); }); },
          [&](const c::DropVertex&) { curved([&] { curve_.drop(); }); },
          [&](const c::ClearCurve&) { curved([&] { curve_.clear(); }); },
          [&](const c::UndoCurve&) { curved([&] { curve_.undo(); }); },
          [&](const c::RedoCurve&) { curved([&] { curve_.redo(); }); },
          [&](const c::SetReach& r) {
            reach_mm_ = std::clamp(r.mm, least_reach_mm, most_reach_mm);
            dirty_ = true;
          },
          [&](const c::PlaceLandmark& l) {
            landmarks_.push_back({l.at_world, next_landmark_++});
          },
          [&](const c::RemoveLandmark& l) {
            std::erase_if(landmarks_, [&](const ui::LandmarkView& it) { return it.number == l.number; });
          },
          [&](const c::AddMeasurePoint& p) { add_measure_point(p.at_world); },
          [&](const c::FinishMeasure&) {
            if (measures_.empty()) return;
            measures_.back().finished = true;
            if (measures_.back().points.size() < 3) measures_.pop_back();
          },
          [&](const c::ClearMeasures&) { measures_.clear(); },
          [&](const c::ChooseMeasure& m) {
            if (!measures_.empty() && !measures_.back().finished) measures_.pop_back();
            measure_ = m.kind;
          },
          [&](const c::BeginContour& b) { contour(b); },
          [&](const c::ExtendContour& e) { contour(e); },
          [&](const c::EndContour& e) { contour(e); },
          [&](const c::RemoveContour& r) { contour(r); },
          [&](const c::ChooseTool& t) {
            tool_ = t.tool;
            curved([&] { curve_.drop(); });
          },
          [&](const c::SetThickness& t) {
            settings_.band.thickness_mm = std::clamp(t.mm, 0.0, 40.0);
            dirty_ = true;
          },
          [&](const c::ChooseCompounding& k) {
            settings_.compounding = k.compounding;
            dirty_ = true;
          },
          [&](const c::ChooseInterpolation& k) {
            settings_.interpolation = k.interpolation;
            dirty_ = true;
          },
          [&](const c::SetLook& l) { look_ = l.look; },
          [&](const c::FillPage& f) { full_ = f.window; },
          [&](const c::SetOrbit& o) { orbit_ = o.orbit; },
          [&](const c::Snapshot& s) { snapshot_ = s.window; },
          [&](const c::SelectExam& e) { selected_ = e.id; },
          [&](const c::OpenExam& e) { show_again(e.id); },
          [&](const c::NewExam&) {
            label_ = new_label_;
            sheet_ = ui::Sheet::none;
            page_ = ui::Page::live;
          },
          [&](const c::TypeLabel& t) {
            if (t.character == 8) {
              while (!new_label_.empty() && (static_cast<unsigned char>(new_label_.back()) & 0xc0) == 0x80)
                new_label_.pop_back();
              if (!new_label_.empty()) new_label_.pop_back();
            } else if (new_label_.size() < longest_label && t.character >= 32 && t.character < 0x800) {
              if (t.character < 0x80) {
                new_label_ += static_cast<char>(t.character);
              } else {
                new_label_ += static_cast<char>(0xc0 | t.character >> 6);
                new_label_ += static_cast<char>(0x80 | (t.character & 63));
              }
            }
          },
          [&](const c::DeleteExam& e) {
            if (e.id == shown_) {
              leave();
              result_.reset();
              ++sweep_version_;
            }
            for (auto s = sweeps_.begin(); s != sweeps_.end(); ++s) {
              if (s->id != e.id) continue;
              deleted_ = std::move(*s);
              sweeps_.erase(s);
              break;
            }
            selected_ = 0;
          },
          [&](const c::UndoDelete&) {
            if (!deleted_) return;
            const auto place = std::find_if(sweeps_.begin(), sweeps_.end(),
                                            [&](const RunSweep& s) { return s.id > deleted_->id; });
            selected_ = deleted_->id;
            sweeps_.insert(place, std::move(*deleted_));
            deleted_.reset();
          },
          [&](const c::ScrollExams& by) {
            first_ = std::clamp(first_ + by.by, 0, static_cast<int>(sweeps_.size()));
          },
          [&](const c::ChoosePedalMode& m) {
            if (m.mode != pedal_mode_)
              say("Hold or toggle is set in this machine's profile and changes at the next start.");
          },
          [&](const c::SetSound& s) { sound_ = s.on; },
          [](const auto&) {},
      },
      command);
}

}  // namespace sonoband
