#include "app/cart/cart.h"

#include <algorithm>
#include <utility>

namespace sonoband::cart {

Cart::Cart(FrameRing& ring, const CartSettings& settings)
    : ring_(ring),
      settings_(settings),
      acquisition_(ring, settings.acquisition),
      debounce_(settings.debounce) {}

void Cart::on_frame(const Frame& frame, Stamp now) {
  if (!machine_.frames) give({Event::Kind::frames_up, now});
  acquisition_.on_frame(frame, now);
  heed_notices();
}

void Cart::on_edge(const PedalEdge& edge, Stamp now) {
  if (edge.pedal != 0) return;
  pedal_delay_ = std::max(now - edge.time, Duration{});
  give(debounce_.edge(edge));
  heed_notices();
}

void Cart::on_pedal_lost(Stamp now) {
  give(debounce_.pedal_lost(now));
  // A toggled recording has nobody at the pedal's other end any more, pressed or not.
  if (machine_.state == State::recording) give({Event::Kind::pedal_lost, now});
  heed_notices();
}

void Cart::on_command(Command command, Stamp now) {
  give({command == Command::record_button ? Event::Kind::button_down : Event::Kind::show_live, now});
  heed_notices();
}

void Cart::on_disk(bool has_room, Stamp now) {
  if (has_room != machine_.disk) give({has_room ? Event::Kind::disk_has_room : Event::Kind::disk_full, now});
}

void Cart::tick(Stamp now) {
  // The contact's time runs as late as its news: of edges that come 300 ms late, the bounces of a press are
  // still under way when its first edge arrives.
  give(debounce_.tick(now - pedal_delay_));
  const std::optional<Stamp> last_frame = acquisition_.status(now).last_frame;
  if (machine_.frames && last_frame && now - *last_frame >= settings_.frames_silent)
    give({Event::Kind::frames_down, now});
  give({Event::Kind::tick, now});
  acquisition_.tick(now);
  heed_notices();
}

void Cart::stop(Stamp now) {
  if (machine_.state == State::recording) give({Event::Kind::frames_down, now});
  acquisition_.stop(now);
  heed_notices();
}

void Cart::give(const std::optional<PedalEvent>& event) {
  if (!event) return;
  if (event->pressed)
    give({Event::Kind::pedal_down, event->time});
  else if (event->cause == PedalEvent::Cause::contact)
    give({Event::Kind::pedal_up, event->time});
  else
    give({Event::Kind::pedal_lost, event->time});
}

void Cart::give(const Event& event) {
  const Transition t = step(machine_, event, settings_.machine);
  machine_ = t.next;
  if (t.note != Note::none) {
    note_ = t.note;
    noted_ = event.time;
  }
  if (t.note == Note::no_frames || t.note == Note::no_disk) acquisition_.count_refused_press();
  if (t.action == Action::begin_sweep) {
    sweep_id_ = acquisition_.begin_sweep(t.at);
    if (sweep_id_ == 0) give({Event::Kind::sweep_refused, t.at});
  }
  if (t.action == Action::end_sweep) acquisition_.end_sweep(t.at);
}

void Cart::heed_notices() {
  while (auto notice = acquisition_.take_notice()) {
    // News of an earlier sweep, which waited for the one before it to end, does not concern the present one.
    const bool present = notice->sweep_id == sweep_id_;
    switch (notice->kind) {
      case Notice::Kind::started:
        if (sweeps_size_ == sweeps_.size()) break;
        sweeps_[(sweeps_first_ + sweeps_size_) % sweeps_.size()] = std::move(notice->sweep);
        ++sweeps_size_;
        break;
      case Notice::Kind::refused:
        if (present) give({Event::Kind::sweep_refused, notice->at});
        break;
      case Notice::Kind::full:
        if (present) give({Event::Kind::sweep_full, notice->at});
        break;
      case Notice::Kind::ended:
        break;
    }
  }
}

std::optional<Sweep> Cart::take_sweep() {
  if (sweeps_size_ == 0) return std::nullopt;
  Sweep sweep = std::move(sweeps_[sweeps_first_]);
  sweeps_first_ = (sweeps_first_ + 1) % sweeps_.size();
  --sweeps_size_;
  return sweep;
}

CartStatus Cart::status(Stamp now) const {
  CartStatus s;
  s.state = machine_.state;
  s.note = note_;
  s.noted = noted_;
  s.recording_since = machine_.since;
  s.pedal_down = debounce_.pressed();
  s.pedal_armed = debounce_.armed();
  s.lost_edges = debounce_.lost_edges();
  s.acquisition = acquisition_.status(now);
  s.ring = ring_.status();
  s.ring_seconds = s.acquisition.unique_hz > 0 ? s.ring.room / s.acquisition.unique_hz : 0;
  return s;
}

}  // namespace sonoband::cart
