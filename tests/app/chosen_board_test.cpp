#include "app/chosen_board.h"

#include <gtest/gtest.h>

#include "app/bad_input.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

std::string refused(const BoardChoice& choice) {
  sim::VirtualClock clock;
  try {
    devices_of(choice, profile_of(choice), clock);
  } catch (const BadInput& e) {
    return e.what();
  }
  return {};
}

TEST(ChosenBoard, OneThatIsNotThereIsRefusedWithTheOnesThatAre) {
  for (const char* name : {"sims", "replay", ""}) {
    BoardChoice choice;
    choice.board = name;
    EXPECT_NE(refused(choice).find("there are the boards sim, replay:FILE, cart"), std::string::npos) << name;
  }
  BoardChoice choice;
  choice.board = "sims";
  EXPECT_THROW(check_of(choice), BadInput);
}

TEST(ChosenBoard, RealDevicesNeedACalibration) {
  BoardChoice choice;
  choice.board = "cart";
  EXPECT_NE(refused(choice).find("--calibration"), std::string::npos);
}

TEST(ChosenBoard, ARecordingThatIsNotThereIsNamed) {
  BoardChoice choice;
  choice.board = "replay:nowhere.mha";
  EXPECT_NE(refused(choice).find("nowhere.mha"), std::string::npos);
}

TEST(ChosenBoard, OnlySimAndReplayKeepTheTimeTheyAreGiven) {
  for (const auto& [name, simulated] :
       {std::pair{"sim", true}, {"replay:x.mha", true}, {"cart", false}, {"virtual", false}}) {
    BoardChoice choice;
    choice.board = name;
    EXPECT_EQ(choice.simulated(), simulated) << name;
  }
}

TEST(ChosenBoard, TheMachinesProfileIsReadOverTheBoards) {
  BoardChoice choice;
  choice.config = "/nowhere/profile.toml";
  EXPECT_THROW(profile_of(choice), ProfileError);
  choice.config.clear();
  EXPECT_GT(profile_of(choice).capture.rate_hz, 0);
}

}  // namespace
}  // namespace sonoband
