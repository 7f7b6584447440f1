// What is there of a board's devices, device by device, before anything is started.
#pragma once

#include <string>
#include <vector>

#include "board/profile.h"

namespace sonoband {

enum class CheckResult { found, warning, missing };

struct CheckLine {
  CheckResult result = CheckResult::missing;
  std::string device;  // tracker, video, pedal, ...
  std::string what;    // what was found, or what is wrong
  std::string cure;    // one sentence; empty when found
};

// Looks for the devices of the board and for what the machine must allow. Takes up to three seconds; starts
// nothing and leaves nothing open. `board` is a name that board_profile knows.
std::vector<CheckLine> check_board(const std::string& board, const Profile& profile);

// This machine's clocks at one moment, s.
struct ClockReadings {
  double day_s = 0;           // CLOCK_REALTIME
  double program_made_s = 0;  // on the same clock; 0 where nobody knows
  double awake_s = 0;         // CLOCK_MONOTONIC, which stands still while the machine is suspended
  double since_boot_s = 0;    // CLOCK_BOOTTIME, which does not; read just after it
};
// What --check says of them.
CheckLine clock_line(const ClockReadings& now);

// One line for people: `found    tracker  LIBERTY HS on USB`.
std::string text_of(const CheckLine& line);
bool all_found(const std::vector<CheckLine>& lines);  // warnings count as found

}  // namespace sonoband
