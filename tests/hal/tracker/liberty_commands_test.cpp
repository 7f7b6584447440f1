// Every command as the exact bytes that go over the wire.
#include "hal/tracker/liberty_commands.h"

#include <gtest/gtest.h>

#include "tests/hal/tracker/wire_support.h"

namespace sonoband::liberty {
namespace {

std::string text(const Command& c) {
  return {c.bytes().begin(), c.bytes().end()};
}

TEST(LibertyCommands, PlainOnesEndInCarriageReturnExceptP) {
  EXPECT_EQ(text(command::start_continuous()), "C\r");
  EXPECT_EQ(text(command::poll()), "P");
  EXPECT_EQ(text(command::end_line()), "\r");
  EXPECT_EQ(text(command::binary(true)), "F1\r");
  EXPECT_EQ(text(command::binary(false)), "F0\r");
  EXPECT_EQ(text(command::centimetres(true)), "U1\r");
  EXPECT_EQ(text(command::rate(Rate::hz_240)), "R4\r");
  EXPECT_EQ(text(command::rate(Rate::hz_120)), "R3\r");
  EXPECT_EQ(text(command::position_filter_off()), "X0,1,0,0\r");
  EXPECT_EQ(text(command::attitude_filter_off()), "Y0,1,0,0\r");
  EXPECT_EQ(text(command::external_sync(false)), "Z0\r");
  EXPECT_EQ(text(command::reset_counters()), "Q0\r");
  EXPECT_EQ(text(command::usb_buffering(false)), "@B0\r");
  EXPECT_EQ(text(command::usb_buffering(true)), "@B1\r");
}

TEST(LibertyCommands, StationsAndLists) {
  EXPECT_EQ(text(command::output_list(all_stations, tracking_list)), "O*,8,9,11,3,7\r");
  EXPECT_EQ(text(command::output_list(2, {Item::position, Item::angles, Item::crlf})), "O2,2,4,1\r");
  EXPECT_EQ(text(command::hemisphere(all_stations, {1, 0, 0})), "H*,1,0,0\r");
  EXPECT_EQ(text(command::clear_tip_offset(all_stations)), "N*,0,0,0\r");
  EXPECT_EQ(text(command::clear_mounting_frame()), "G0,0,0\r");
  EXPECT_EQ(text(command::hemisphere(16, {0.5F, -1, 0})), "H16,0.5,-1,0\r");
}

TEST(LibertyCommands, LongestListFits) {
  OutputList list;
  list.count = OutputList::capacity;
  list.codes.fill(12);
  EXPECT_EQ(text(command::output_list(16, list)).size(), 3u + 20 * 3 + 1);
}

TEST(LibertyCommands, ControlCommandsAreTheRawByte) {
  EXPECT_EQ(text(command::ask_stations()),
            "\x15"
            "0\r");
  EXPECT_EQ(text(command::ask_identity()), "\x16\r");
  EXPECT_EQ(text(command::ask_sensor_identity(3)),
            "\x16"
            "3\r");
  EXPECT_EQ(text(command::ask_self_test()), "\x14\r");
  EXPECT_EQ(text(command::clear_self_test()),
            "\x14"
            "0\r");
  EXPECT_EQ(text(command::clear_boresight(all_stations)), "\x02*\r");
  EXPECT_EQ(text(command::clear_alignment(all_stations)), "\x12*\r");
  EXPECT_EQ(text(command::echo(false)),
            "\x05"
            "0\r");
  EXPECT_EQ(text(command::reinitialise()), "\x19\r");
}

TEST(LibertyCommands, Questions) {
  EXPECT_EQ(text(command::ask_binary()), "F\r");
  EXPECT_EQ(text(command::ask_units()), "U\r");
  EXPECT_EQ(text(command::ask_output_list(1)), "O1\r");
  EXPECT_EQ(text(command::ask_rate()), "R\r");
  EXPECT_EQ(text(command::ask_position_filter()), "X\r");
  EXPECT_EQ(text(command::ask_attitude_filter()), "Y\r");
  EXPECT_EQ(text(command::ask_usb_buffering()), "@B\r");
  EXPECT_EQ(text(command::ask_hemisphere(2)), "H2\r");
}

TEST(LibertyLists, SizesOfKnownLists) {
  EXPECT_EQ(tracking_list.body_bytes(), 40u);
  EXPECT_EQ((OutputList{Item::position, Item::angles, Item::crlf}.body_bytes()), 26u);
  EXPECT_EQ((OutputList{Item::time_ms, Item::frame_count, Item::distortion, Item::position_extended,
                        Item::angles_extended}
                 .body_bytes()),
            36u);
  EXPECT_EQ((OutputList{Item::position, Item::quaternion, Item::time_ms, Item::frame_count, Item::distortion,
                        Item::sync}
                 .body_bytes()),
            44u);
}

}  // namespace
}  // namespace sonoband::liberty
