// The board that the operator named, with the machine's profile: its devices, or what is found of them.
#pragma once

#include <string>

#include "board/check.h"
#include "board/devices.h"

namespace sonoband {

// As given on the command line.
struct BoardChoice {
  std::string board = "sim";  // sim, replay:FILE, cart, raspberrypi or virtual
  std::string config;         // the machine's profile (TOML); empty: the board's own
  std::string calibration;    // PLUS configuration (XML); empty: none

  // Its devices know no other time than the clock they are given.
  bool simulated() const { return board == "sim" || board.starts_with("replay:"); }
};

// The profile the board comes with, and what the machine's own says otherwise. Throws ProfileError.
Profile profile_of(const BoardChoice& choice);

// The clock must outlive them. Throws BadInput for a board that is not there, a recording or a calibration
// that cannot be used, and a board of real devices without a calibration.
BoardDevices devices_of(const BoardChoice& choice, const Profile& profile, Clock& clock);

// What is found of the board's devices on this machine. Throws BadInput, ProfileError.
std::vector<CheckLine> check_of(const BoardChoice& choice);

}  // namespace sonoband
