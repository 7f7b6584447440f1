#include "app/screen/session.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reslice/default_plane.h"
#include "core/review/measure.h"
#include "ui/interact/cross.h"
#include "ui/interact/plane_motion.h"

namespace sonoband {
namespace {

constexpr double slow_ms = 60;  // from here a full rendering is felt to lag behind the finger
constexpr double cine_hz = 25;  // B-scans a second
constexpr double fling_halves_s = 0.35;
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

}  // namespace

RenderSettings Session::usual_settings() {
  RenderSettings s;
  s.band.thickness_mm = 14;
  return s;
}

const RunSweep* Session::shown() const {
  for (const RunSweep& s : sweeps_) {
    if (s.id == shown_) return &s;
  }
  return nullptr;
}

std::int32_t Session::frame_count() const {
  const RunSweep* s = shown();
  return s == nullptr ? 0 : static_cast<std::int32_t>(s->held.view.frames.size());
}

void Session::begin_sweep(std::uint64_t id) {
  changed_ = true;
  growing_ = id;
  growing_held_.reset();
  page_ = ui::Page::live;
  sheet_ = ui::Sheet::none;
  ++sweep_version_;
}

void Session::grow_sweep(const RunSweep& sweep, bool done) {
  changed_ = true;
  if (!done) {
    growing_held_ = sweep.held;
    ++sweep_version_;
    // The plane through what there is so far; nothing to show while the probe has not moved.
    if (sweep.held.view.frames.size() < 8) return;
    settings_.band.step_mm = pixel_width_mm(sweep.held.view);
    if (const auto plane = default_plane(sweep.held.view, PlaneView::upright)) {
      plane_ = *plane;
      dirty_ = true;
      shown_ = 0;
    }
    return;
  }
  growing_held_.reset();
  growing_ = 0;
  sweeps_.push_back(sweep);
  sweeps_.back().label = label_;
  if (sweep.held.view.frames.empty()) {
    say("No B-scan of that sweep has a place in space: look at the tracker's lamp.");
    return;
  }
  show(sweeps_.back());
  page_ = ui::Page::review;
}

bool Session::let_go_oldest() {
  if (deleted_) {
    deleted_.reset();
    return true;
  }
  for (auto s = sweeps_.begin(); s != sweeps_.end(); ++s) {
    if (s->id == shown_) continue;
    sweeps_.erase(s);
    say("An older sweep was let go to make room for new ones.");
    return true;
  }
  return false;
}

void Session::show(const RunSweep& sweep) {
  shown_ = sweep.id;
  selected_ = sweep.id;
  ++sweep_version_;
  const std::size_t middle = sweep.held.view.frames.size() / 2;
  current_ = static_cast<double>(middle);
  playing_ = false;
  fling_ = 0;
  landmarks_.clear();
  measures_.clear();
  contours_.clear();
  next_landmark_ = 1;
  settings_.band.step_mm = pixel_width_mm(sweep.held.view);
  curve_ = ui::CurveEditor(settings_.band.step_mm);
  result_.reset();
  reset_plane();
}

void Session::reset_plane() {
  const RunSweep* s = shown();
  if (s == nullptr) return;
  const auto plane = default_plane(s->held.view, PlaneView::upright);
  if (!plane) return;
  const ReslicePlane before = plane_;
  plane_ = *plane;
  content_px_ = {plane->width, plane->height};
  shape_plane();
  curve_plane_ = ui::carried(curve_plane_, before, plane_);
}

void Session::shape_plane() {
  plane_ = ui::shaped(plane_, content_px_[0], content_px_[1], width_per_height_);
  dirty_ = true;
}

Eigen::Vector2d Session::to_curve(const Eigen::Vector2d& mm) const {
  return ui::on_plane(curve_plane_, ui::from_plane(plane_, mm)).mm;
}

void Session::show_curve(std::span<const Eigen::Vector2d> points, std::vector<Eigen::Vector2d>& out) const {
  out.clear();
  for (const Eigen::Vector2d& p : points)
    out.push_back(ui::on_plane(plane_, ui::from_plane(curve_plane_, p)).mm);
}

void Session::say(std::string notice, Duration how_long) {
  notice_ = std::move(notice);
  notice_for_ = how_long;
  changed_ = true;
  notice_until_.reset();
}

std::optional<ui::Window> Session::take_snapshot() {
  return std::exchange(snapshot_, std::nullopt);
}

void Session::add_measure_point(const Eigen::Vector3d& p) {
  if (measures_.empty() || measures_.back().finished) measures_.push_back({measure_, {}, false});
  MeasureItem& m = measures_.back();
  m.points.push_back(p);
  const std::size_t needs = m.kind == ui::Measure::distance ? 2 : 3;
  if (m.kind != ui::Measure::area && m.points.size() == needs) m.finished = true;
}

double Session::value_of(const MeasureItem& m) const {
  switch (m.kind) {
    case ui::Measure::distance:
      return path_mm(m.points);
    case ui::Measure::angle:
      return m.points.size() == 3 ? angle_deg(m.points[0], m.points[1], m.points[2]) : 0;
    case ui::Measure::area:
      break;
  }
  return area_mm2(m.points);
}

void Session::contour(const ui::Command& command) {
  namespace c = ui::command;
  const auto now = static_cast<std::int32_t>(current_);
  if (const auto* begin = std::get_if<c::BeginContour>(&command)) {
    contours_.push_back({now, {begin->at_px}, false});
  } else if (const auto* extend = std::get_if<c::ExtendContour>(&command)) {
    if (contours_.empty() || contours_.back().finished) return;
    // A point a pixel from the last adds nothing but work.
    if ((extend->to_px - contours_.back().points.back()).norm() >= 1.0)
      contours_.back().points.push_back(extend->to_px);
  } else if (std::holds_alternative<c::EndContour>(command)) {
    if (contours_.empty() || contours_.back().finished) return;
    contours_.back().finished = true;
    if (contours_.back().points.size() < 3) contours_.pop_back();
  } else {
    std::erase_if(contours_, [&](const ContourItem& item) { return item.frame == now; });
  }
}

void Session::apply(const ui::Command& command) {
  namespace c = ui::command;
  changed_ = true;
  const auto last = static_cast<double>(std::max(0, frame_count() - 1));
  const auto show_frame = [&](double index) {
    current_ = std::clamp(index, 0.0, last);
    fling_ = 0;
  };
  const auto move = [&](const ReslicePlane& plane) {
    if (frame_count() == 0) return;
    plane_ = plane;
    dirty_ = true;
  };
  const auto move_out = [&](const ReslicePlane& plane) {
    if (frame_count() > 0) curve_plane_ = ui::carried(curve_plane_, plane_, plane);
    move(plane);
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
          [&](const c::PushPlane& by) { move_out(ui::pushed(plane_, by.by_mm)); },
          [&](const c::TiltPlane& by) {
            move_out(ui::tilted(plane_, by.about_right_rad, by.about_down_rad, by.about_mm));
          },
          [&](const c::ResetPlane&) { reset_plane(); },
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
          [&](const c::OpenExam& e) {
            for (const RunSweep& s : sweeps_) {
              if (s.id != e.id || s.held.view.frames.empty()) continue;
              show(s);
              page_ = ui::Page::review;
              break;
            }
          },
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
              shown_ = 0;
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

void Session::ask() {
  RenderRequest request;
  if (const RunSweep* s = shown()) {
    request.sweep = s->held;
    if (curve_.line().size() > 1) request.curve_mm = curve_.line();
    request.curve_plane = curve_plane_;
    request.reach_mm = reach_mm_;
  } else if (growing_held_) {
    request.sweep = *growing_held_;
  } else {
    return;
  }
  request.sweep_version = sweep_version_;
  request.plane = plane_;
  request.settings = settings_;
  const auto last = worker_.newest();
  const double full_ms = last ? last->planar->ms * (last->planar->coarse ? 4 : 1) : 0;
  request.coarse = touching_ && full_ms > slow_ms;
  worker_.ask(std::move(request));
}

void Session::tick(Stamp now) {
  const double dt = last_tick_ ? std::clamp(seconds(now - *last_tick_), 0.0, 0.2) : 0;
  last_tick_ = now;
  if (!notice_.empty() && !notice_until_) notice_until_ = now + notice_for_;
  if (notice_until_ && now >= *notice_until_) {
    notice_.clear();
    notice_until_.reset();
    changed_ = true;
  }
  const double count = std::max(1, frame_count());
  if (playing_) current_ = std::fmod(current_ + dt * cine_hz, count);
  if (fling_ != 0) {
    current_ = std::clamp(current_ + dt * fling_, 0.0, count - 1);
    fling_ *= std::exp2(-dt / fling_halves_s);
    if (std::abs(fling_) < 1 || current_ <= 0 || current_ >= count - 1) fling_ = 0;
  }
  ask_if_changed();
}

void Session::ask_if_changed() {
  if (!dirty_) return;
  dirty_ = false;
  ask();
}

void Session::fill(ui::View& view) {
  changed_ = false;
  result_ = worker_.newest();
  view.page = page_;
  view.sheet = sheet_;
  view.sheet_source = sheet_source_;
  view.notice = notice_;

  ui::ReviewView& r = view.review;
  r.look = look_;
  r.tool = tool_;
  r.measure = measure_;
  r.full = full_;
  r.orbit = orbit_;
  r.settings = settings_;
  r.plane = plane_;
  r.sweep_version = sweep_version_;
  view.live.sweep_version = sweep_version_;
  view.live.compounding = settings_.compounding;
  view.live.growing_mm = settings_.band.thickness_mm;
  ui::Picture band;
  if (result_) {
    const BandImage& b = result_->planar->band;
    band = {b.pixels.view(), b.coverage.view(), b.kind, result_->planar->version};
  }
  if (growing_ != 0) {
    if (growing_held_) {
      r.frames = growing_held_->view.frames;
      if (shown_ == 0) view.live.growing = band;
    }
  } else if (const RunSweep* s = shown()) {
    r.frames = s->held.view.frames;
    r.current = std::clamp(static_cast<std::int32_t>(current_), 0, frame_count() - 1);
    r.playing = playing_;
    const TrackedFrame& f = *r.frames[r.current];
    r.bscan = {f.bscan.pixels, {}, f.bscan.kind, (s->id << 32) + static_cast<std::uint64_t>(r.current) + 1};
    r.has_doppler = f.bscan.kind == PixelKind::doppler;
    r.band = band;
    view.live.growing = band;
    if (result_) {
      r.band_plane = result_->planar->plane;
      r.band_ms = result_->planar->ms;
      r.band_coarse = result_->planar->coarse;
    }
  }

  r.curve = {};
  show_curve(curve_.line(), line_);
  show_curve(curve_.handles(), vertices_);
  r.curve.line = line_;
  r.curve.vertices = vertices_;
  r.curve.reach_mm = reach_mm_;
  r.curve.drawing = curve_.drawing();
  r.curve.can_undo = curve_.can_undo();
  r.curve.can_redo = curve_.can_redo();
  smear_views_.clear();
  if (result_ && result_->manifold && !curve_.line().empty() && shown_ != 0) {
    const ManifoldPicture& m = *result_->manifold;
    r.manifold = {m.band.pixels.view(), m.band.coverage.view(), m.band.kind, m.version};
    r.manifold_thickness_mm = m.thickness_mm;
    r.manifold_pixel_mm = m.pixel_mm;
    r.manifold_coarse = m.coarse;
    const auto show_runs = [&](const std::vector<PlaneLine>& runs, std::vector<PlaneLine>& out) {
      out.resize(runs.size());
      for (std::size_t i = 0; i < runs.size(); ++i) show_curve(runs[i], out[i]);
    };
    show_runs(m.up, up_);
    show_runs(m.down, down_);
    r.curve.up = up_;
    r.curve.down = down_;
    r.curve.length_mm = m.length_mm;
    r.curve.layers = m.layers;
    for (const Stretch& s : m.smeared) smear_views_.push_back({s.from_mm, s.to_mm});
    r.curve.smeared = smear_views_;
  }

  r.landmarks = landmarks_;
  measure_views_.clear();
  for (const MeasureItem& m : measures_)
    measure_views_.push_back({m.kind, m.points, value_of(m), m.finished});
  r.measures = measure_views_;
  contour_views_.clear();
  for (const ContourItem& item : contours_) {
    double area = 0;
    if (item.finished && item.frame < static_cast<std::int32_t>(r.frames.size())) {
      const TrackedFrame& f = *r.frames[item.frame];
      const double cell = f.world_from_image.linear.col(0).cross(f.world_from_image.linear.col(1)).norm();
      double twice = 0;
      for (std::size_t i = 0; i < item.points.size(); ++i) {
        const Eigen::Vector2d& a = item.points[i];
        const Eigen::Vector2d& b = item.points[(i + 1) % item.points.size()];
        twice += a.x() * b.y() - a.y() * b.x();
      }
      area = std::abs(twice) / 2 * cell;
    }
    contour_views_.push_back({item.frame, item.points, item.finished, area});
  }
  r.contours = contour_views_;

  exam_views_.clear();
  for (auto s = sweeps_.rbegin(); s != sweeps_.rend(); ++s) {
    ui::ExamView e;
    e.id = s->id;
    e.label = s->label;
    e.when = s->when;
    e.sweeps = 1;
    e.frames = static_cast<int>(s->held.view.frames.size());
    e.seconds = s->seconds;
    e.open = s->id == shown_;
    if (!s->held.view.frames.empty()) {
      e.picture = {
          s->held.view.frames[s->held.view.frames.size() / 2]->bscan.pixels, {}, PixelKind::grey, s->id};
    }
    exam_views_.push_back(e);
  }
  view.exams.exams = exam_views_;
  view.exams.selected = selected_;
  view.exams.first = first_;
  view.exams.new_label = new_label_;
  view.exams.can_undo_delete = deleted_.has_value();
  view.set_up.pedal_mode = pedal_mode_;
  view.set_up.sound = sound_;
}

}  // namespace sonoband
