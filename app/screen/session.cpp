#include "app/screen/session.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reslice/default_plane.h"
#include "ui/interact/cross.h"
#include "ui/interact/plane_motion.h"

namespace sonoband {
namespace {

// Of a frame at 60 a second, less what it takes to hand the band to the screen: what takes longer is coarse
// at first, while a finger moves.
constexpr double budget_ms = 12;
// A finger that is down and still: so long, and so many turns, as a turn may be slow.
constexpr Duration rests_after = std::chrono::milliseconds(150);
constexpr int rests_after_turns = 4;
constexpr double cine_hz = 25;  // B-scans a second
constexpr double fling_halves_s = 0.35;

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
  if (opened_ && opened_->id == shown_) return &*opened_;
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
      leave();
      plane_ = *plane;
      dirty_ = true;
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
  leave();
  shown_ = sweep.id;
  selected_ = sweep.id;
  ++sweep_version_;
  const std::size_t middle = sweep.held.view.frames.size() / 2;
  current_ = static_cast<double>(middle);
  playing_ = false;
  fling_ = 0;
  push_rest_mm_ = 0;
  landmarks_.clear();
  measures_.clear();
  contours_.clear();
  next_landmark_ = 1;
  next_mark_ = 1;
  plane_chosen_ = false;
  settings_.band.step_mm = pixel_width_mm(sweep.held.view);
  curve_ = ui::CurveEditor(settings_.band.step_mm);
  result_.reset();
  reset_plane();
  // Of a sweep that is shown for the first time everything is news.
  review_changed_ = true;
  review_rests_.reset();
  if (const auto known = reviews_.find(sweep.id); known != reviews_.end()) {
    restore(known->second);
    review_changed_ = false;
  }
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

void Session::ask(bool moving) {
  RenderRequest request;
  if (const RunSweep* s = shown()) {
    request.sweep = s->held;
    request.sweep_id = s->id;
    if (curve_.line().size() > 1) request.curve_mm = curve_.line();
    request.curve_plane = curve_plane_;
    request.reach_mm = reach_mm_;
  } else if (growing_held_) {
    request.sweep = *growing_held_;
    request.sweep_id = growing_;
  } else {
    return;
  }
  request.sweep_version = sweep_version_;
  request.plane = plane_;
  request.settings = settings_;
  request.moving = asked_moving_ = moving;
  request.budget_ms = budget_ms;
  request.drag_ahead = std::exchange(push_ahead_, false) && shown() != nullptr;
  asked_at_ = last_tick_;
  turns_since_ = 0;
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
  // A finger that rests sees the band in full.
  if (asked_moving_ && ++turns_since_ >= rests_after_turns && asked_at_ && now - *asked_at_ >= rests_after)
    ask(false);
}

void Session::ask_if_changed() {
  if (!dirty_) return;
  dirty_ = false;
  ask(touching_);
}

}  // namespace sonoband
