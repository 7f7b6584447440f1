// One turn of the screen: news of the cart into the view, the view onto the surface, commands carried out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/screen/run.h"
#include "app/screen/session.h"
#include "app/screen/status_view.h"
#include "ui/screen.h"

namespace sonoband {

class ScreenLoop {
 public:
  ScreenLoop(cart::Appliance& cart, const std::function<bool(bool down)>& foot, const ScreenOptions& options,
             ui::Surface& surface);

  // Takes what the cart has to say. True: there is something new to draw.
  bool listen(Stamp now);
  // Draws a frame and carries out what it asked for.
  void draw(const ui::Input& input, Stamp now);

  bool quits() const { return quits_; }
  bool wants_full_screen_toggle() { return std::exchange(toggle_, false); }
  bool rendering() const { return worker_.busy(); }
  const ui::Screen& screen() const { return screen_; }
  cart::State state() const { return state_; }
  // Pixels of the last frame, or of the widget called `part` of it, to this file in the shots folder.
  void save(const std::string& file, std::string_view part = {});

 private:
  struct Motion {
    Eigen::Vector3d middle;  // of the B-scan
    Eigen::Vector3d normal;
    Stamp at{};
  };
  void carry_out(const ui::Command& command);
  void press(bool down);
  void follow_sweep(Stamp now);
  void measure_speed(const TrackedFrame& frame);

  cart::Appliance& cart_;
  std::function<bool(bool)> foot_;
  ScreenOptions options_;
  ui::Surface& surface_;
  RenderWorker worker_;
  Session session_;
  ui::Screen screen_;
  ui::View view_;
  LossLines losses_{};
  std::shared_ptr<Sweep> growing_;
  std::optional<Stamp> next_growth_;
  cart::State state_ = cart::State::idle;
  std::uint64_t drawn_picture_ = 0;
  std::uint64_t drawn_result_ = 0;
  std::optional<Stamp> next_status_;
  std::optional<Motion> motion_;
  double speed_mm_s_ = 0;
  bool recorded_ = false;  // in this run
  bool button_started_ = false;
  bool quits_ = false;
  bool toggle_ = false;
  int snapshots_ = 0;
};

}  // namespace sonoband
