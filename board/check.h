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

// One line for people: `found    tracker  LIBERTY HS on USB`.
std::string text_of(const CheckLine& line);
bool all_found(const std::vector<CheckLine>& lines);  // warnings count as found

}  // namespace sonoband
