// What --check says of the machine's clocks.
#include <gtest/gtest.h>

#include "board/check.h"

namespace sonoband {
namespace {

constexpr double made = 1.7e9;

TEST(ClockCheck, IsFoundWhereTimeGoesOn) {
  const CheckLine line =
      clock_line({.day_s = made + 1, .program_made_s = made, .awake_s = 500, .since_boot_s = 500.0005});
  EXPECT_EQ(line.result, CheckResult::found);
  EXPECT_EQ(line.cure, "");
}

TEST(ClockCheck, ATimeOfDayBeforeTheProgramWasMadeIsSaid) {
  const CheckLine line =
      clock_line({.day_s = made - 1, .program_made_s = made, .awake_s = 20, .since_boot_s = 20});
  EXPECT_EQ(line.result, CheckResult::warning);
  EXPECT_EQ(line.what, "the time of day is before this program was made");
  EXPECT_NE(line.cure.find("timedatectl set-time"), std::string::npos);
}

TEST(ClockCheck, AMachineThatSleptIsSaid) {
  const CheckLine line =
      clock_line({.day_s = made + 1, .program_made_s = made, .awake_s = 500, .since_boot_s = 500.01});
  EXPECT_EQ(line.result, CheckResult::warning);
  EXPECT_EQ(line.what, "the machine was suspended since it booted");
}

TEST(ClockCheck, ThisMachineIsAsked) {
  for (const CheckLine& line : check_board("sim", *board_profile("sim")))
    if (line.device == "clock") return;
  ADD_FAILURE() << "no line speaks of the clock";
}

}  // namespace
}  // namespace sonoband
