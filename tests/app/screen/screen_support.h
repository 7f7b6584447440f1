// A simulated cart with a screen in memory, and faults where a test wants them.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "app/screen/loop.h"
#include "app/screen/player.h"
#include "hal/sim/liberty_sim.h"
#include "hal/sim/sim_footswitch.h"
#include "hal/sim/sim_frame_source.h"
#include "hal/sim/virtual_clock.h"
#include "ui/host/headless.h"

namespace sonoband::test {

struct CartFaults {
  std::vector<sim::FrameFault> frames;  // from the start of the cart
  std::vector<sim::Fault> tracker;      // at: from the clock's start
  std::vector<sim::PedalFault> pedal;
};

struct ScreenCartSettings {
  ScreenOptions screen;
  CartFaults faults;
  std::uint32_t ring_frames = 300;
  double frames_hz = 30;
  std::filesystem::path exams;  // empty: nothing is saved
  // For tests that look at the picture; all have it where SONOBAND_SHOTS is set.
  bool pixels = false;
  bool doppler = false;  // of the vessels, in place of the foetus in grey
  // The scanner's pictures are so much coarser, for tests that want many of them.
  int coarser = 1;
};

// The clock starts at 1000 s. One at a time; the thread that makes it plays.
class ScreenCart {
 public:
  explicit ScreenCart(ScreenCartSettings settings = {});
  ~ScreenCart();  // stops the cart

  void play(const std::string& script);
  // The screen drawn anew with all it waits for; fails the test when GL had an error since the start.
  void draw();
  // Draws, and gives the pixels; fails the test when the cart has none.
  ui::Rgba shot();
  // Draws; with SONOBAND_SHOTS set, NAME.png there.
  void show(const std::string& name);
  bool has(const std::string& widget) const { return loop().screen().widgets().find(widget).has_value(); }
  ScreenLoop& loop() const { return *loop_; }
  Player& player() { return *player_; }
  ui::HeadlessSurface& surface() { return *surface_; }
  cart::Appliance& cart() { return *cart_; }
  const Foot& foot() const { return foot_; }
  Clock& clock() { return *clock_; }
  const ScreenOptions& options() const { return settings_.screen; }

 private:
  ScreenCartSettings settings_;
  std::shared_ptr<sim::VirtualClock> clock_ = std::make_shared<sim::VirtualClock>();
  std::optional<ClockMember> member_;
  std::unique_ptr<cart::Appliance> cart_;
  Foot foot_;
  std::unique_ptr<ui::HeadlessSurface> surface_;
  std::unique_ptr<ScreenLoop> loop_;
  std::unique_ptr<Player> player_;
};

// Plays frames until it is so; false: it did not become so. For disks, which work in real time, while the
// cart's clock goes frame by frame.
template <class Condition>
bool until(ScreenCart& cart, const Condition& condition,
           std::chrono::seconds at_most = std::chrono::seconds(60)) {
  // An export lets everything else go first: beside other tests it waits longest.
  const auto end = std::chrono::steady_clock::now() + at_most;
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    cart.player().frame();
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  return condition();
}

// Of one test, empty at its start.
std::filesystem::path scratch_folder();

}  // namespace sonoband::test
