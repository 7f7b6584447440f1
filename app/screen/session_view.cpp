// The session as the screen shows it.
#include <algorithm>

#include "app/screen/session.h"

namespace sonoband {

void Session::fill(ui::View& view) {
  changed_ = false;
  result_ = worker_.newest();
  // Of the sweep that was shown before there is nothing to see any more.
  if (result_ && result_->sweep_id != (growing_ != 0 ? growing_ : shown_)) result_.reset();
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
  } else if (const RunSweep* s = shown(); s != nullptr && frame_count() > 0) {
    r.frames = s->held.view.frames;
    r.current = std::clamp(static_cast<std::int32_t>(current_), 0, frame_count() - 1);
    r.playing = playing_;
    const TrackedFrame& f = *r.frames[r.current];
    r.bscan = {f.bscan.pixels, {}, f.bscan.kind, (s->id << 32) + static_cast<std::uint64_t>(f.sequence) + 1};
    r.has_doppler = f.bscan.kind == PixelKind::doppler;
    r.band = band;
    view.live.growing = band;
    if (result_) {
      r.band_plane = result_->planar->plane;
      r.band_ms = result_->planar->ms;
      r.band_left_out = result_->planar->band.frames_left_out;
      r.band_coarse = result_->planar->coarse;
    }
  }

  fill_curve(r);
  fill_marks(r);
  fill_exams(view.exams);
  view.set_up.pedal_mode = pedal_mode_;
  view.set_up.sound = sound_;
}

void Session::fill_curve(ui::ReviewView& r) {
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
}

void Session::fill_marks(ui::ReviewView& r) {
  r.landmarks = landmarks_;
  measure_views_.clear();
  for (const MeasureItem& m : measures_)
    measure_views_.push_back({m.kind, m.points, measured(m.kind, m.points), m.finished});
  r.measures = measure_views_;
  contour_views_.clear();
  for (const ContourItem& c : contours_)
    contour_views_.push_back({c.number, c.frame, c.plane.has_value(), c.points, c.finished, c.area_mm2});
  r.contours = contour_views_;
}

void Session::fill_exams(ui::ExamsView& exams) {
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
  exams.exams = exam_views_;
  exams.selected = selected_;
  exams.first = first_;
  exams.new_label = new_label_;
  exams.can_undo_delete = deleted_.has_value();
}

}  // namespace sonoband
