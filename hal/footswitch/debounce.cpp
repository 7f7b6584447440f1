#include "hal/footswitch/debounce.h"

#include <algorithm>

namespace sonoband {

std::optional<PedalEvent> Debounce::edge(const PedalEdge& e) {
  const Stamp time = bouncing_ ? std::max(e.time, last_edge_) : e.time;
  // A bouncing that was over before this edge is settled first.
  const std::optional<PedalEvent> event = tick(time);

  if (last_sequence_ && e.sequence > *last_sequence_ + 1) lost_edges_ += e.sequence - *last_sequence_ - 1;
  last_sequence_ = e.sequence;
  pedal_ = e.pedal;
  const bool report = e.sequence == 0;  // the level at start: there may have been no edge at all
  if (bouncing_ || report || e.closed != closed_) {
    if (!bouncing_) first_edge_ = time;
    bouncing_ = true;
    last_edge_ = time;
  }
  closed_ = e.closed;
  return event;
}

std::optional<PedalEvent> Debounce::tick(Stamp now) {
  if (auto event = settle(now)) return event;
  const bool releasing = bouncing_ && !closed_;
  if (pressed_ && !releasing && now - pressed_since_ >= settings_.stuck_limit) {
    pressed_ = false;
    armed_ = false;
    return PedalEvent{pressed_since_ + settings_.stuck_limit, false, pedal_, PedalEvent::Cause::stuck};
  }
  return std::nullopt;
}

std::optional<PedalEvent> Debounce::settle(Stamp now) {
  if (!bouncing_ || now - last_edge_ < settings_.quiet) return std::nullopt;
  bouncing_ = false;
  if (!closed_) armed_ = true;
  if (closed_ == pressed_ || (closed_ && !armed_)) return std::nullopt;
  pressed_ = closed_;
  pressed_since_ = first_edge_;
  return PedalEvent{first_edge_, pressed_, pedal_, PedalEvent::Cause::contact};
}

std::optional<PedalEvent> Debounce::pedal_lost(Stamp now) {
  const bool was_pressed = pressed_;
  pressed_ = false;
  armed_ = false;
  bouncing_ = false;
  closed_ = false;
  last_sequence_.reset();
  if (!was_pressed) return std::nullopt;
  return PedalEvent{now, false, pedal_, PedalEvent::Cause::lost};
}

std::optional<Stamp> Debounce::next_tick() const {
  if (bouncing_) return last_edge_ + settings_.quiet;
  if (pressed_) return pressed_since_ + settings_.stuck_limit;
  return std::nullopt;
}

}  // namespace sonoband
