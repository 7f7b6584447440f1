// One turn of the screen: news of the cart into the view, the view onto the surface, commands carried out.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/screen/exam_desk.h"
#include "app/screen/run.h"
#include "app/screen/session.h"
#include "app/screen/status_view.h"
#include "ui/screen.h"

namespace sonoband {

class ScreenLoop {
 public:
  // `rendered` is called on another thread when a rendering is done, for a surface that sleeps.
  ScreenLoop(cart::Appliance& cart, const Foot& foot, const ScreenOptions& options, ui::Surface& surface,
             const std::function<void()>& rendered = {});

  // Takes what the cart has to say. True: there is something new to draw.
  bool listen(Stamp now);
  // How the board's touchscreen is; not called where there is none.
  void tell_touch(const DeviceHealth& health);
  // What makes the cues of recording, and outlives the loop; without it there is no sound.
  void give_sound(CuePlayer* cues) { cues_ = cues; }
  // Draws a frame and carries out what it asked for.
  void draw(const ui::Input& input, Stamp now);

  bool quits() const { return quits_; }
  bool wants_full_screen_toggle() { return std::exchange(toggle_, false); }
  void wait_for_renderings() const { worker_.wait(); }
  // A rendering waits to be drawn.
  bool rendered() const;
  // How long nothing can be missed by sleeping, input and finished renderings aside.
  Duration may_sleep() const;

  // What the last draw took of this thread's processor time, for the speed table.
  struct Times {
    Duration view{};     // the cart's and the session's news into the view
    Duration panels{};   // the panels' drawing commands
    Duration sending{};  // new pictures to the graphics processor
    Duration gl{};       // the driver's work for Outline and frame; with a software rasteriser all of it
    Duration commands{};
  };
  const Times& times() const { return times_; }
  const RenderWorker& worker() const { return worker_; }
  const Session& session() const { return session_; }
  // Of the last frame; pictures and lists in it are no longer valid.
  const ui::View& view() const { return view_; }
  std::uint64_t sweeps_taken() const { return sweeps_taken_; }
  const ui::Screen& screen() const { return screen_; }
  cart::State state() const { return state_; }
  ui::Vec2 size_px() const { return surface_.size_px(); }
  // Pixels of the last frame, or of the widget called `part` of it, to this file in the shots folder.
  void save(const std::string& file, std::string_view part = {});

 private:
  struct Motion {
    Eigen::Vector3d middle;  // of the B-scan
    Eigen::Vector3d normal;
    Stamp at{};
  };
  // What the lamps show of the devices; a change is drawn at once.
  struct Lamps {
    DeviceState scanner{}, tracker{}, pedal{};
    cart::State state{};
    bool frozen = false, pedal_down = false;
    PoseQuality quality{};
    bool operator==(const Lamps&) const = default;
  };
  void fill(Stamp now);
  void fill_live(Stamp now, double fps);
  void hand_on_band();
  void take_snapshot(ui::Window window);
  void carry_out(const ui::Command& command);
  void press(bool down);
  void follow_sweep(Stamp now);
  void measure_speed(const TrackedFrame& frame);

  cart::Appliance& cart_;
  Foot foot_;
  ScreenOptions options_;
  ui::Surface& surface_;
  RenderWorker worker_;
  Session session_;
  std::unique_ptr<ExamDesk> desk_;  // null: nothing is saved
  ui::Screen screen_;
  ui::View view_;
  LossLines losses_{};
  LossLedger at_press_;      // the cart's ledger when the sweep began
  LossLedger sweep_ledger_;  // of the growing or last sweep
  std::shared_ptr<Sweep> growing_;
  std::optional<Stamp> next_growth_;
  cart::State state_ = cart::State::idle;
  // Where sweeps are saved, or else snapshots.
  const std::filesystem::path& storage() const;
  std::string saving_;  // what is wrong with saving
  double fps_ = 25;     // that the scanner sends when it does
  Lamps lamps_;
  std::optional<DeviceHealth> touch_;
  CuePlayer* cues_ = nullptr;
  FrameLease lease_;  // while a frame is made
  std::array<ui::ProbeView, 1> probes_;
  std::uintmax_t disk_bytes_ = 0;
  std::optional<Stamp> disk_asked_;
  Stamp noted_{};
  Stamp drawn_picture_{};
  std::uint64_t drawn_result_ = 0;
  std::uint64_t handed_band_ = 0;
  std::optional<Stamp> next_numbers_;
  std::optional<Motion> motion_;
  double speed_mm_s_ = 0;
  Times times_;
  std::uint64_t sweeps_taken_ = 0;  // in this run
  bool button_started_ = false;
  bool quits_ = false;
  bool toggle_ = false;
  int snapshots_ = 0;
};

}  // namespace sonoband
