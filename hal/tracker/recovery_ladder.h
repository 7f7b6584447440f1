// What to do about trouble: the mildest cure first, the next one if the trouble is back within 10 s.
//
// | rung         | cure                                                        | takes about |
// |--------------|-------------------------------------------------------------|-------------|
// | restart      | send `C` again                                              | 0.25 s      |
// | reconfigure  | stop, drain, identify, configure, verify, start             | 1 s         |
// | reset_port   | USB reset, open again, and the above                        | 2 s         |
// | reinitialise | `^Y`, wait out the self-test, and the above                 | 10 to 20 s  |
// | give_up      | tell the operator; once more every 10 s, with `^Y` every 60 s        |             |
//
// `^Y` is never sent during a recording, nor to a unit that came less than 15 s ago: it may still be in the
// self-test of its power-up, silent for up to 10 s. Nor before trouble has lasted for 5 s, unless the unit
// itself asks for it: resets of USB take half a second each, and a bad contact may be over before a restart.
#pragma once

#include <cstdint>

#include "hal/tracker/link_types.h"

namespace sonoband {

enum class Rung : std::uint8_t { none, restart, reconfigure, reset_port, reinitialise, give_up };

class RecoveryLadder {
 public:
  void came(Stamp now);       // the device was found: nothing was tried on it yet
  void restarted(Stamp now);  // `^Y` was sent: it is silent for a while
  void healthy(Stamp now);    // while records come
  Rung next(LinkReason trouble, Stamp now, bool recording);
  bool young(Stamp now) const;  // it came so lately that silence may be its self-test

 private:
  Rung climbed_ = Rung::none;
  Stamp began_{};  // the trouble that was first climbed for
  Stamp last_trouble_{};
  Stamp came_{};
  Stamp restarted_{};
};

}  // namespace sonoband
