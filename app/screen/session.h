// What the operator has made of the sweeps of this run: the page shown, the plane, the curve, marks,
// settings. Commands of the screen change it, the view shows it. One thread; knows no device.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/screen/render_worker.h"
#include "app/screen/review_objects.h"
#include "ui/command.h"
#include "ui/interact/curve_editor.h"
#include "ui/view.h"

namespace sonoband {

// A sweep that can be shown: of this run, or out of an exam.
struct RunSweep {
  HeldSweep held;
  std::uint64_t id = 0;  // the same for the same sweep as long as the program runs
  std::string label;
  std::string when;
  double seconds = 0;
};

class Session {
 public:
  Session(RenderWorker& worker, ui::PedalMode pedal_mode) : worker_(worker), pedal_mode_(pedal_mode) {}

  // A sweep has started: the live page shows its band as it grows.
  void begin_sweep(std::uint64_t id);
  // It has grown; called as often as it pays. `done`: it is complete, and is shown in Review.
  void grow_sweep(const RunSweep& sweep, bool done);
  // The oldest sweep but the one shown is let go, to make room. False: there is none.
  bool let_go_oldest();
  std::size_t sweep_count() const { return sweeps_.size() + (deleted_ ? 1 : 0); }

  // A sweep out of an exam, as far as it is loaded; `review` counts when this run has not shown it yet.
  void open(RunSweep sweep, const SweepReview& review);
  // More of it is loaded.
  void grow_opened(const HeldSweep& held);
  // Shows a sweep that is still in memory. False: it is not.
  bool show_again(std::uint64_t id);
  // Its exam is deleted.
  void forget(std::uint64_t id);
  std::uint64_t shown_id() const { return shown_; }
  // How bands are made, as last chosen.
  const RenderSettings& settings() const { return settings_; }
  std::span<const RunSweep> sweeps() const { return sweeps_; }

  // Sweeps whose review has changed and has come to rest, or been left (`all`: come to rest or not). Told
  // once; `note_change` has it told again.
  std::vector<std::uint64_t> take_changed(Stamp now, bool all = false);
  void note_change(std::uint64_t id) { left_changed_.push_back(id); }
  SweepReview review_of(std::uint64_t id) const;

  // Carries out what belongs to it; the others (pedal, windows, quitting) are the caller's.
  void apply(const ui::Command& command);

  // Time passes: cine, flicks, notices; asks the worker for what has changed.
  void tick(Stamp now);

  // What the commands changed is asked of the worker now, not at the next tick.
  void ask_if_changed();
  // Since the last fill, by a command or by time.
  bool changed() const { return changed_; }

  // Fills pages, review, exams and the growing band; what it lends stays valid until the next call of
  // anything here.
  void fill(ui::View& view);

  // Something moves by itself: draw another frame.
  bool moving() const { return playing_ || fling_ != 0; }

  void say(std::string notice, Duration how_long = std::chrono::seconds(5));
  ui::Page page() const { return page_; }
  ui::Sheet sheet() const { return sheet_; }
  bool sound() const { return sound_; }
  const std::string& typed_label() const { return new_label_; }
  ui::PedalMode pedal_mode() const { return pedal_mode_; }
  // A snapshot was asked for: of this window (none: the whole screen). Asked once.
  std::optional<ui::Window> take_snapshot();

 private:
  struct MeasureItem {
    ui::Measure kind = ui::Measure::distance;
    std::vector<Eigen::Vector3d> points;
    bool finished = false;
    int number = 0;
  };
  struct ContourItem {
    std::int32_t frame = 0;             // negative: on a plane, or its B-scan is not loaded yet
    std::optional<ReslicePlane> plane;  // that it was drawn on; empty: on a B-scan
    std::vector<Eigen::Vector3d> points;
    bool finished = false;
    int number = 0;
    Stamp captured{};  // of its B-scan
    double area_mm2 = 0;
  };

  void show(const RunSweep& sweep);
  void leave();  // the sweep shown, whose review is kept
  SweepReview review() const;
  void restore(const SweepReview& review);
  void find_contours();
  void reset_plane();
  void ask(bool moving);
  const RunSweep* shown() const;
  std::int32_t frame_count() const;
  void add_measure_point(const Eigen::Vector3d& p);
  void contour(const ui::Command& command);
  void fill_curve(ui::ReviewView& review);
  void fill_marks(ui::ReviewView& review);
  void fill_exams(ui::ExamsView& exams);

  RenderWorker& worker_;
  std::vector<RunSweep> sweeps_;                  // newest last
  std::optional<RunSweep> deleted_;               // the last one, until another is deleted or room is needed
  std::optional<RunSweep> opened_;                // out of an exam
  std::map<std::uint64_t, SweepReview> reviews_;  // of the sweeps not shown
  std::vector<std::uint64_t> left_changed_;
  bool review_changed_ = false;  // of the sweep shown
  std::optional<Stamp> review_rests_;
  std::uint64_t shown_ = 0;
  std::uint64_t growing_ = 0;
  std::uint64_t sweep_version_ = 1;
  std::optional<HeldSweep> growing_held_;

  ui::Page page_ = ui::Page::live;
  ui::Sheet sheet_ = ui::Sheet::none;
  ui::Source sheet_source_ = ui::Source::scanner;
  ui::Tool tool_ = ui::Tool::move;
  ui::Measure measure_ = ui::Measure::distance;
  ui::Window full_ = ui::Window::none;
  ui::Orbit orbit_;
  ui::Look look_;
  ui::PedalMode pedal_mode_;
  bool sound_ = true;

  // In a window wider than the sweep the plane is wider as well.
  void shape_plane();
  // From the plane that is shown to the curve's, and back: moves within the plane leave the curve where it
  // was drawn, on the anatomy; moves out of it take the curve along.
  Eigen::Vector2d to_curve(const Eigen::Vector2d& mm) const;
  void show_curve(std::span<const Eigen::Vector2d> points, std::vector<Eigen::Vector2d>& out) const;

  ReslicePlane plane_;
  ReslicePlane curve_plane_;
  std::array<int, 2> content_px_{};  // of the plane that just holds the sweep
  double width_per_height_ = 1;      // of the Reslice window
  bool plane_chosen_ = false;        // by the operator: stays as more of the sweep is loaded
  RenderSettings settings_ = usual_settings();
  ui::CurveEditor curve_;
  double reach_mm_ = 20;
  double current_ = 0;  // of the B-scans; a part of one while it plays
  bool playing_ = false;
  double fling_ = 0;  // B-scans a second
  bool touching_ = false;
  bool push_ahead_ = false;    // the next request is told of it
  double push_rest_mm_ = 0;    // that the finger has pushed beyond whole steps
  bool asked_moving_ = false;  // by a finger that has not come to rest since
  std::optional<Stamp> asked_at_;
  int turns_since_ = 0;
  std::optional<Stamp> last_tick_;

  std::vector<ui::LandmarkView> landmarks_;
  std::vector<MeasureItem> measures_;
  std::vector<ContourItem> contours_;
  int next_landmark_ = 1;
  int next_mark_ = 1;  // of measurements and contours

  std::string new_label_;
  std::string label_;
  std::uint64_t selected_ = 0;
  int first_ = 0;
  std::optional<ui::Window> snapshot_;
  std::string notice_;
  std::optional<Stamp> notice_until_;
  Duration notice_for_{};

  // What the worker was last asked for.
  bool dirty_ = false;
  bool changed_ = true;
  std::shared_ptr<const RenderResult> result_;
  // Lent to the view.
  std::vector<Eigen::Vector2d> line_, vertices_;
  std::vector<PlaneLine> up_, down_;
  std::vector<ui::MeasureView> measure_views_;
  std::vector<ui::ContourView> contour_views_;
  std::vector<ui::CurveView::Smear> smear_views_;
  std::vector<ui::ExamView> exam_views_;

  static RenderSettings usual_settings();
};

}  // namespace sonoband
