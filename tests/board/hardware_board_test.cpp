// The boards with real devices, on a machine that has none: everything is waited for and said.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "board/check.h"
#include "board/devices.h"

namespace sonoband {
namespace {

Profile nothing_there() {
  Profile p = *board_profile("cart");
  p.capture.device = "/dev/no-such-grabber";
  p.pedal.pin = "NO_SUCH_LINE";
  p.touch.device = "/dev/no-such-panel";
  return p;
}

TEST(HardwareBoard, WaitsForDevicesThatAreNotThere) {
  SystemClock clock;
  BoardDevices board = make_hardware_board("cart", {}, nothing_there(), clock);
  board.frames->start();
  board.footswitch->start();
  Frame frame;
  PedalEdge edge;
  EXPECT_EQ(board.frames->read(frame, std::chrono::milliseconds(5)), ReadStatus::nothing_yet);
  EXPECT_EQ(board.footswitch->read(edge, std::chrono::milliseconds(5)), ReadStatus::nothing_yet);
  EXPECT_EQ(board.frames->health().state, DeviceState::absent);
  EXPECT_STRNE(board.frames->health().reason, "");
  EXPECT_EQ(board.footswitch->health().state, DeviceState::absent);
  EXPECT_EQ(board.width_px, 1920);
  board.touch->start();
  TouchEvent touch;
  EXPECT_EQ(board.touch->read(touch, std::chrono::milliseconds(5)), ReadStatus::nothing_yet);
  EXPECT_EQ(board.touch->health().state, DeviceState::absent);
  EXPECT_STRNE(board.touch->health().reason, "");
  EXPECT_FALSE(board.foot) << "a real pedal is not pressed by a program";
}

TEST(HardwareBoard, ACameraThatIsNotThereIsWaitedForAndSaid) {
  SystemClock clock;
  Profile p = nothing_there();
  p.capture.driver = "libcamera";
  BoardDevices board = make_hardware_board("cart", {}, p, clock);
  board.frames->start();
  Frame frame;
  EXPECT_EQ(board.frames->read(frame, std::chrono::milliseconds(5)), ReadStatus::nothing_yet);
  EXPECT_EQ(board.frames->health().state, DeviceState::absent);
  const auto lines = check_board("cart", p);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const CheckLine& l) {
    return l.device == "video" && l.what == "no grabber as /dev/no-such-grabber for libcamera";
  }));
}

TEST(HardwareBoard, TheProfilesWordsReachTheDevices) {
  Profile p = *board_profile("raspberrypi");
  p.tracking.station = 3;
  p.tracking.hemisphere = {0, 0, 1};
  const auto pedals = pedal_wiring(p);
  ASSERT_EQ(pedals.size(), 1u);
  EXPECT_EQ(pedals[0].closes.name, "GPIO17");
  EXPECT_EQ(pedals[0].closes.bias, Bias::pull_up);
  EXPECT_TRUE(pedals[0].closes.active_low);
  ASSERT_TRUE(pedals[0].opens);
  EXPECT_EQ(pedals[0].opens->name, "GPIO27");
  EXPECT_EQ(tracker_config(p).probe_station, 3);
  EXPECT_EQ(tracker_config(p).hemisphere[2], 1);
  EXPECT_EQ(tracker_config(p).rate, RecordRate::hz_240);
  p.screen.width_mm = 217;
  p.touch.rotation_deg = 180;
  EXPECT_EQ(touch_mapping(p).rotation_deg, 180);
  EXPECT_EQ(touch_mapping(p).width_mm, 217);
  p.touch.rotation_deg = 90;
  EXPECT_EQ(touch_mapping(p).width_mm, 0) << "the width lies along the panel's y axis";
}

TEST(Check, SaysForEachDeviceWhatIsMissingAndTheCure) {
  const auto lines = check_board("cart", nothing_there());
  for (const char* device : {"video", "pedal"}) {
    const auto line =
        std::find_if(lines.begin(), lines.end(), [&](const CheckLine& l) { return l.device == device; });
    ASSERT_NE(line, lines.end());
    EXPECT_EQ(line->result, CheckResult::missing) << text_of(*line);
    EXPECT_FALSE(line->cure.empty());
  }
  const auto touch =
      std::find_if(lines.begin(), lines.end(), [](const CheckLine& line) { return line.device == "touch"; });
  ASSERT_NE(touch, lines.end());
  EXPECT_EQ(touch->result, CheckResult::warning) << "a mouse works as well";
  EXPECT_NE(text_of(*touch).find("/dev/no-such-panel"), std::string::npos);
  EXPECT_FALSE(all_found(lines));
  EXPECT_TRUE(all_found(check_board("sim", Profile{})));
}

}  // namespace
}  // namespace sonoband
