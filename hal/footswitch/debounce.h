// Presses out of the raw edges of one bouncing contact. Pure: edges and time go in, presses come out.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/devices.h"

namespace sonoband {

struct DebounceSettings {
  // Contacts bounce for 1 to 6 ms, large old pedals for tens of ms. Shorter loses presses on those, longer
  // only delays the announcement: the press is stamped at its first edge whatever this is.
  Duration quiet = std::chrono::milliseconds(25);
  Duration stuck_limit = std::chrono::seconds(120);  // a pedal down for longer is taken for jammed
};

struct PedalEvent {
  Stamp time{};  // of the first edge; for a stuck or lost pedal when that was found
  bool pressed = false;
  std::uint8_t pedal = 0;
  enum class Cause : std::uint8_t { contact, stuck, lost } cause = Cause::contact;
};

// A change counts once the contact has kept its level for `quiet`; shorter spikes are nothing. Nothing is
// pressed before the pedal has been seen up: at power-up, after a loss and after a jam a pedal that is down
// must come up first. Lost edges (a jump of the sequence number) are counted; the level read afterwards
// decides.
//
// Feed every edge of one pedal in order, and call tick at next_tick or now and then; how often changes only
// when an event comes out, not what it says. Each call gives at most one event.
class Debounce {
 public:
  explicit Debounce(const DebounceSettings& settings = {}) : settings_(settings) {}

  std::optional<PedalEvent> edge(const PedalEdge& e);
  std::optional<PedalEvent> tick(Stamp now);
  std::optional<PedalEvent> pedal_lost(Stamp now);  // unplugged, or its link is down

  std::optional<Stamp> next_tick() const;
  bool pressed() const { return pressed_; }
  bool armed() const { return armed_; }  // the next press will count
  std::uint64_t lost_edges() const { return lost_edges_; }

 private:
  std::optional<PedalEvent> settle(Stamp now);

  DebounceSettings settings_;
  std::uint8_t pedal_ = 0;
  bool closed_ = false;  // the last level seen
  bool bouncing_ = false;
  Stamp first_edge_{};  // of the present bouncing
  Stamp last_edge_{};
  bool pressed_ = false;
  Stamp pressed_since_{};
  bool armed_ = false;
  std::optional<std::uint64_t> last_sequence_;
  std::uint64_t lost_edges_ = 0;
};

}  // namespace sonoband
