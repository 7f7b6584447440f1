// What the cart is doing, as a pure function: state and event in, state and action out.
//
//             frames_up            press                    release, press again, full, lost
//     idle ─────────────▶ live ───────────▶ recording ────────────────────────────▶ review
//       ◀───────────────    ◀──────────────────────────────────────────────────────    │
//          frames_down                        show_live                     press ─────▶ recording
#pragma once

#include <cstdint>

#include "board/profile.h"
#include "core/time.h"

namespace sonoband::cart {

enum class State : std::uint8_t {
  idle,       // no pictures come
  live,       // pictures are shown, the pre-roll is kept
  recording,  // a sweep grows
  review,     // the last sweep is on the screen; pictures go on behind it
};
const char* name_of(State state);

struct Event {
  enum class Kind : std::uint8_t {
    pedal_down,  // clean presses and releases (hal/footswitch/debounce.h), with the stamp of their first edge
    pedal_up,
    pedal_lost,     // unplugged, or stuck: taken for released
    button_down,    // the screen's record button: starts and ends like a toggling pedal
    frames_up,      // the frame source delivers
    frames_down,    // and does not any more
    show_live,      // the operator leaves the review
    sweep_refused,  // acquisition had no room to begin the sweep
    sweep_full,     // the growing sweep can take no more; time: of the first frame refused
    disk_full,      // exams are to be saved and there is no room for another sweep
    disk_has_room,  // there is again
    tick,           // time passes
  } kind = Kind::tick;
  Stamp time{};
};

struct MachineSettings {
  PedalMode pedal = PedalMode::hold;
  // A toggling press so soon after the one that started is a slip of the foot, not a stop. Usual: 300 ms.
  Duration repress = std::chrono::milliseconds(300);
  // A recording that no held pedal keeps going ends after this. Usual: 120 s. For a held pedal the
  // stuck-pedal limit of the debouncer does the same.
  Duration longest = std::chrono::seconds(120);
};

struct Machine {
  State state = State::idle;
  bool frames = false;  // pictures come
  bool disk = true;     // a sweep that starts now can be saved, or none is to be
  bool held = false;    // the recording goes on while the pedal is down
  Stamp since{};        // when the recording started
};

enum class Action : std::uint8_t { none, begin_sweep, end_sweep };

// Why something happened that the operator did not ask for, or why what he asked for did not happen.
enum class Note : std::uint8_t {
  none,
  no_frames,    // a press without pictures starts nothing
  too_soon,     // a second press within `repress` does not stop
  no_room,      // the sweep could not begin: drop or save older sweeps
  sweep_full,   // the sweep ended because memory was full
  too_long,     // the recording reached `longest`
  pedal_lost,   // the sweep ended because the pedal went away or is stuck
  frames_lost,  // the sweep ended because the pictures stopped
  no_disk,      // a press with no room on the disk starts nothing
};
// One sentence with the cure; "" for none.
const char* sentence_of(Note note);

struct Transition {
  Machine next;
  Action action = Action::none;
  Stamp at{};  // when the action takes effect: the event's own time, not the time of its arrival
  Note note = Note::none;
};

Transition step(const Machine& machine, const Event& event, const MachineSettings& settings);

}  // namespace sonoband::cart
