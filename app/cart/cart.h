// The cart without its devices and threads: what comes from them goes in, with times, and the examination
// comes out. Debouncer, state machine and acquisition, wired.
#pragma once

#include <cstdint>
#include <optional>

#include "app/cart/acquisition.h"
#include "app/cart/state_machine.h"
#include "hal/footswitch/debounce.h"

namespace sonoband::cart {

struct CartSettings {
  AcquisitionSettings acquisition;
  MachineSettings machine;
  DebounceSettings debounce;
  // Pictures silent for so long are gone: the cart is idle, a recording ends. Usual: 1 s.
  Duration frames_silent = std::chrono::seconds(1);
};

enum class Command : std::uint8_t { record_button, show_live };

struct CartStatus {
  State state = State::idle;
  Note note = Note::none;  // the last thing worth telling
  Stamp noted{};           // and when it happened
  Stamp recording_since{};
  bool pedal_down = false;
  bool pedal_armed = false;  // the next press counts
  std::uint64_t lost_edges = 0;
  AcquisitionStatus acquisition;
  RingStatus ring;
  double ring_seconds = 0;  // of pictures that sweeps can still take, at the present rate; 0 without pictures
};

// One thread, the writer of the ring; no heap and no lock once made. `now` never goes back.
class Cart {
 public:
  Cart(FrameRing& ring, const CartSettings& settings);

  void on_pose(const PoseSample& sample, Stamp now) { acquisition_.on_pose(sample, now); }
  void on_frame(const Frame& frame, Stamp now);
  void on_edge(const PedalEdge& edge, Stamp now);  // of pedal 0; of others nothing is made
  void on_pedal_lost(Stamp now);
  void on_command(Command command, Stamp now);
  // Whether a sweep that starts now could be saved. Without this call it is taken for granted.
  void on_disk(bool has_room, Stamp now);
  void count_overruns(std::uint64_t poses, std::uint64_t edges) { acquisition_.count_overruns(poses, edges); }
  void tick(Stamp now);  // some 50 times a second or more
  void stop(Stamp now);  // ends what is recorded

  // Sweeps as they start, oldest first; the caller decides how long each is held. At most 16 wait here, a
  // sweep that nobody takes goes when it has ended.
  std::optional<Sweep> take_sweep();

  State state() const { return machine_.state; }
  CartStatus status(Stamp now) const;

 private:
  void give(const Event& event);
  void give(const std::optional<PedalEvent>& event);
  void heed_notices();

  FrameRing& ring_;
  CartSettings settings_;
  Acquisition acquisition_;
  Debounce debounce_;
  Machine machine_;
  std::int32_t sweep_id_ = 0;  // of the sweep that the machine asked for last
  Duration pedal_delay_{};     // between the last edge and its arrival here
  Note note_ = Note::none;
  Stamp noted_{};
  std::array<Sweep, 16> sweeps_;  // circular
  std::size_t sweeps_first_ = 0;
  std::size_t sweeps_size_ = 0;
};

}  // namespace sonoband::cart
