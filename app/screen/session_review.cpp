// The session's sweeps out of exams, and what is kept of the review of each sweep.
#include <algorithm>
#include <utility>

#include "app/screen/session.h"
#include "core/review/measure.h"
#include "ui/interact/plane_motion.h"

namespace sonoband {
namespace {

// After the last change; a finger that drags makes one picture's worth of changes a frame.
constexpr Duration at_rest_after = std::chrono::milliseconds(200);

std::int32_t index_of(std::span<const TrackedFrame* const> frames, Stamp captured) {
  const auto at = std::lower_bound(frames.begin(), frames.end(), captured,
                                   [](const TrackedFrame* f, Stamp t) { return f->captured < t; });
  return at == frames.end() ? -1 : static_cast<std::int32_t>(at - frames.begin());
}

}  // namespace

void Session::open(RunSweep sweep, const SweepReview& review) {
  reviews_.try_emplace(sweep.id, review);
  leave();
  opened_ = std::move(sweep);
  show(*opened_);
  page_ = ui::Page::review;
  changed_ = true;
}

void Session::grow_opened(const HeldSweep& held) {
  if (!opened_) return;
  const bool is_shown = opened_->id == shown_;
  const auto at = static_cast<std::size_t>(std::max(0.0, current_));
  const auto before = opened_->held.view.frames;
  const Stamp captured = is_shown && at < before.size() ? before[at]->captured : Stamp{};
  const HeldSweep former = std::exchange(opened_->held, held);  // lends `before`
  if (!is_shown) return;
  if (!before.empty()) current_ = std::max(0, index_of(held.view.frames, captured));
  find_contours();
  ++sweep_version_;
  changed_ = true;
  dirty_ = true;
  if (!plane_chosen_) reset_plane();
}

bool Session::show_again(std::uint64_t id) {
  if (id == shown_ && shown() != nullptr) {
    page_ = ui::Page::review;
    return true;
  }
  for (const RunSweep& s : sweeps_) {
    if (s.id != id || s.held.view.frames.empty()) continue;
    show(s);
    page_ = ui::Page::review;
    return true;
  }
  return false;
}

void Session::forget(std::uint64_t id) {
  if (id == shown_) leave();
  reviews_.erase(id);
  std::erase(left_changed_, id);
  std::erase_if(sweeps_, [&](const RunSweep& s) { return s.id == id; });
  if (opened_ && opened_->id == id) opened_.reset();
  changed_ = true;
}

void Session::leave() {
  if (shown() != nullptr) {
    reviews_[shown_] = review();
    if (std::exchange(review_changed_, false)) left_changed_.push_back(shown_);
  }
  if (opened_ && opened_->id == shown_) opened_.reset();
  shown_ = 0;
  result_.reset();
  ++sweep_version_;
}

std::vector<std::uint64_t> Session::take_changed(Stamp now, bool all) {
  std::vector<std::uint64_t> changed = std::exchange(left_changed_, {});
  if (!review_changed_ || shown() == nullptr) return changed;
  const bool under_way = touching_ || curve_.drawing() || curve_.holding();
  if (under_way || !review_rests_) review_rests_ = now + at_rest_after;
  if (!all && now < *review_rests_) return changed;
  review_changed_ = false;
  changed.push_back(shown_);
  return changed;
}

SweepReview Session::review_of(std::uint64_t id) const {
  if (id == shown_) return review();
  const auto known = reviews_.find(id);
  return known == reviews_.end() ? SweepReview{} : known->second;
}

SweepReview Session::review() const {
  SweepReview r;
  if (frame_count() > 0 && content_px_[0] > 0) {
    // As large as the sweep needs it: the windows' shape is not the operator's doing.
    const auto [width, height] = content_px_;
    r.plane = ui::shaped(plane_, width, height, static_cast<double>(width) / height);
    r.content_px = content_px_;
  }
  r.settings = settings_;
  r.reach_mm = reach_mm_;
  r.curve = curve_.kept();
  r.curve_plane = curve_plane_;
  r.landmarks = landmarks_;
  for (const MeasureItem& m : measures_)
    if (m.finished) r.measurements.push_back({m.number, m.kind, m.points});
  for (const ContourItem& c : contours_)
    if (c.finished) r.contours.push_back({c.number, c.captured, c.plane, c.points});
  return r;
}

void Session::restore(const SweepReview& r) {
  if (r.plane) {
    plane_ = *r.plane;
    content_px_ = r.content_px;
    plane_chosen_ = true;
    shape_plane();
  }
  const double step_mm = settings_.band.step_mm;  // the sweep's
  settings_ = r.settings;
  settings_.band.step_mm = step_mm;
  reach_mm_ = r.reach_mm;
  curve_.restore(r.curve);
  if (!r.curve.line.empty()) curve_plane_ = r.curve_plane;
  landmarks_ = r.landmarks;
  for (const ui::LandmarkView& l : landmarks_) next_landmark_ = std::max(next_landmark_, l.number + 1);
  for (const SweepReview::Measurement& m : r.measurements) {
    measures_.push_back({m.kind, m.points, true, m.number});
    next_mark_ = std::max(next_mark_, m.number + 1);
  }
  for (const SweepReview::Contour& c : r.contours) {
    contours_.push_back({-1, c.plane, c.points, true, c.number, c.captured, area_mm2(c.points)});
    next_mark_ = std::max(next_mark_, c.number + 1);
  }
  find_contours();
  dirty_ = true;
}

void Session::find_contours() {
  const RunSweep* s = shown();
  for (ContourItem& c : contours_) {
    if (!c.finished || c.plane) continue;
    c.frame = s == nullptr ? -1 : index_of(s->held.view.frames, c.captured);
    if (c.frame >= 0 && s->held.view.frames[c.frame]->captured != c.captured) c.frame = -1;
  }
}

}  // namespace sonoband
