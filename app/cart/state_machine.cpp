#include "app/cart/state_machine.h"

#include <algorithm>

namespace sonoband::cart {
namespace {

using Kind = Event::Kind;

Transition begin(Machine m, const Event& e, bool held) {
  if (!m.frames) return {m, Action::none, {}, Note::no_frames};
  if (!m.disk) return {m, Action::none, {}, Note::no_disk};
  m.state = State::recording;
  m.held = held;
  m.since = e.time;
  return {m, Action::begin_sweep, e.time, Note::none};
}

Transition end(Machine m, Stamp at, Note note = Note::none) {
  m.state = State::review;
  m.held = false;
  return {m, Action::end_sweep, std::max(at, m.since), note};
}

Transition while_recording(const Machine& m, const Event& e, const MachineSettings& settings) {
  const Transition nothing{m, Action::none, {}, Note::none};
  switch (e.kind) {
    case Kind::pedal_down:
    case Kind::button_down:
      if (m.held && e.kind == Kind::pedal_down) return nothing;
      if (e.time - m.since < settings.repress && !m.held) return {m, Action::none, {}, Note::too_soon};
      return end(m, e.time);
    case Kind::pedal_up:
      return m.held ? end(m, e.time) : nothing;
    case Kind::pedal_lost:
      return end(m, e.time, Note::pedal_lost);
    case Kind::frames_down:
      return end(m, e.time, Note::frames_lost);
    case Kind::sweep_full:
      return end(m, e.time, Note::sweep_full);
    case Kind::sweep_refused: {
      Machine live = m;
      live.state = m.frames ? State::live : State::idle;
      live.held = false;
      return {live, Action::none, {}, Note::no_room};
    }
    case Kind::tick:
      if (m.held || e.time - m.since < settings.longest) return nothing;
      return end(m, m.since + settings.longest, Note::too_long);
    case Kind::frames_up:
    case Kind::show_live:
    case Kind::disk_full:  // what has begun goes on into the reserve
    case Kind::disk_has_room:
      return nothing;
  }
  return nothing;
}

Transition while_not_recording(Machine m, const Event& e, const MachineSettings& settings) {
  switch (e.kind) {
    case Kind::pedal_down:
      return begin(m, e, settings.pedal == PedalMode::hold);
    case Kind::button_down:
      return begin(m, e, false);
    case Kind::frames_up:
    case Kind::frames_down:
      if (m.state != State::review) m.state = m.frames ? State::live : State::idle;
      return {m, Action::none, {}, Note::none};
    case Kind::show_live:
      m.state = m.frames ? State::live : State::idle;
      return {m, Action::none, {}, Note::none};
    case Kind::sweep_refused:
      return {m, Action::none, {}, Note::no_room};
    case Kind::pedal_up:
    case Kind::pedal_lost:
    case Kind::sweep_full:
    case Kind::disk_full:
    case Kind::disk_has_room:
    case Kind::tick:
      break;
  }
  return {m, Action::none, {}, Note::none};
}

}  // namespace

const char* name_of(State state) {
  switch (state) {
    case State::idle:
      return "idle";
    case State::live:
      return "live";
    case State::recording:
      return "recording";
    case State::review:
      return "review";
  }
  return "";
}

const char* sentence_of(Note note) {
  switch (note) {
    case Note::none:
      return "";
    case Note::no_frames:
      return "No sweep was started because no pictures come: check the scanner's video cable.";
    case Note::too_soon:
      return "The second press came too soon to be meant as a stop: press again to stop.";
    case Note::no_room:
      return "No sweep was started because earlier sweeps fill the memory: discard one.";
    case Note::sweep_full:
      return "The sweep ended because the memory is full: discard earlier sweeps before the next.";
    case Note::too_long:
      return "The sweep ended at the longest time allowed: press again to record more.";
    case Note::pedal_lost:
      return "The sweep ended because the pedal was lost or is stuck: check its plug and release it.";
    case Note::frames_lost:
      return "The sweep ended because the pictures stopped: check the scanner and its video cable.";
    case Note::no_disk:
      return "No sweep was started because the disk has no room for it: export exams and delete them.";
  }
  return "";
}

Transition step(const Machine& machine, const Event& event, const MachineSettings& settings) {
  Machine m = machine;
  if (event.kind == Kind::frames_up) m.frames = true;
  if (event.kind == Kind::frames_down) m.frames = false;
  if (event.kind == Kind::disk_full) m.disk = false;
  if (event.kind == Kind::disk_has_room) m.disk = true;
  return m.state == State::recording ? while_recording(m, event, settings)
                                     : while_not_recording(m, event, settings);
}

}  // namespace sonoband::cart
