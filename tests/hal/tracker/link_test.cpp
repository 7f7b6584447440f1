// The link's machine by itself, with made-up time: what it sends, in which order, and when.
#include "hal/tracker/link.h"

#include <gtest/gtest.h>

#include <string>

#include "hal/tracker/little_endian.h"
#include "tests/hal/tracker/wire_support.h"

namespace sonoband {
namespace {

using test::Bytes;
using test::operator+;  // NOLINT(misc-unused-using-decls): clang-tidy 14 misses operators

// Plays an obedient unit by hand: answers questions, stays silent to settings.
class Conversation {
 public:
  explicit Conversation(Bytes tag) : tag_(std::move(tag)) {}

  // Turns until the machine has nothing more to send before `until`.
  void run(double until_s) {
    while (now_ < until_s) {
      LinkInput in{.now = Stamp(std::chrono::seconds(1000)) + from_seconds(now_), .port = port_};
      const Bytes incoming = std::move(incoming_);
      incoming_.clear();
      in.bytes = incoming;
      const LinkOutput out = link.turn(in);
      if (out.action == LinkOutput::PortAction::open) port_ = PortState::open;
      if (!out.write.empty()) {
        sent += std::string(out.write.begin(), out.write.end());
        answer(std::string(out.write.begin(), out.write.end()));
      }
      for (const Reading& r : link.readings()) readings.push_back(r);
      now_ += 0.001;
    }
  }
  void hear(const Bytes& bytes) { incoming_ = incoming_ + bytes; }

  Link link{LinkConfig{}};
  std::string sent;
  std::vector<Reading> readings;
  Bytes wrong_units;  // answer to U instead of the right one

 private:
  Bytes reply(std::uint8_t station, std::uint8_t command, const Bytes& body) const {
    Bytes header = tag_ + Bytes{station, command, 0, 0, static_cast<std::uint8_t>(body.size()), 0};
    return header + body;
  }
  void answer(const std::string& command) {
    if (command == "\x16\r") hear(reply(0, 0x16, Bytes{4, 0, 0} + test::ascii("A unit\r\n")));
    if (command == "F\r") hear(reply(0, 'F', test::hex("01000000")));
    if (command == "U\r") hear(reply(0, 'U', wrong_units.empty() ? test::hex("01000000") : wrong_units));
    if (command == "O1\r")
      hear(reply(1, 'O', test::hex("08000000 09000000 0b000000 03000000 07000000 ffffffff")));
    if (command == "H1\r") hear(reply(1, 'H', test::hex("0000803f 00000000 00000000")));
    if (command == "X\r") hear(reply(0, 'X', test::hex("00000000 0000803f 00000000 00000000")));
    if (command == "Y\r") hear(reply(0, 'Y', test::hex("00000000 0000803f 00000000 00000000")));
    if (command == "R\r") hear(reply(0, 'R', test::hex("04000000")));
    if (command ==
        "\x15"
        "0\r")
      hear(reply(0, 0x15, test::hex("0100 0100")));
  }

  Bytes tag_;
  double now_ = 0;
  PortState port_ = PortState::absent;
  Bytes incoming_;
};

TEST(Link, SaysExactlyThisToALiberty) {
  Conversation c(test::ascii("LY"));
  c.run(2);
  const std::string expected =
      "P\r"
      "F1\r\x16\r"
      "\x05"
      "0\rU1\rO*,8,9,11,3,7\rX0,1,0,0\rY0,1,0,0\rR4\r@B0\rH*,1,0,0\r\x02*\r\x12*\rN*,0,0,0\rG0,0,0\r"
      "F\rU\rO1\rH1\rX\rY\rR\r\x15"
      "0\r"
      "Q0\rC\rC\rC\r"  // no record comes
      "P\rF1\r";       // so once more from the start
  EXPECT_EQ(c.sent.substr(0, expected.size()), expected);
}

TEST(Link, LeavesOutWhatAPatriotHasNot) {
  Conversation c(test::ascii("PA"));
  c.run(1.05);
  EXPECT_EQ(c.sent.find('R'), std::string::npos) << c.sent;
  EXPECT_EQ(c.sent.find('G'), std::string::npos);
  EXPECT_NE(c.sent.find("Q0\rC\r"), std::string::npos);
}

TEST(Link, ASettingThatDoesNotStandIsSetOnceMoreThenItIsTrouble) {
  Conversation c(test::ascii("LY"));
  c.wrong_units = test::hex("00000000");
  c.run(2.2);
  std::size_t settings = 0;
  for (std::size_t p = c.sent.find("U1\r"); p != std::string::npos; p = c.sent.find("U1\r", p + 1))
    ++settings;
  EXPECT_GE(settings, 2u);
  EXPECT_EQ(c.sent.find("C\r"), std::string::npos);
  EXPECT_EQ(c.link.reason(), LinkReason::mismatch);
}

TEST(Link, FirstRecordsSettleThenFlow) {
  Conversation c(test::ascii("LY"));
  c.run(1.05);
  ASSERT_EQ(c.link.state(), LinkState::starting);
  Bytes record = test::example::stream;
  for (std::uint32_t f = 1; f <= 60; ++f) {
    wire::store_u32(record.data() + 8, f * 1000 / 240);
    wire::store_u32(record.data() + 12, f);
    c.hear(record);
    c.run(1.05 + f / 240.0);
  }
  EXPECT_EQ(c.link.state(), LinkState::streaming);
  ASSERT_GT(c.readings.size(), 30u);
  EXPECT_EQ(c.link.counters().settling + c.readings.size(), 60u);
  const PoseSample& p = c.readings.back().pose;
  EXPECT_EQ(p.device_frame, 60u);
  EXPECT_EQ(p.quality, PoseQuality::good);
  EXPECT_TRUE(p.tracker_from_probe.translation.isApprox(Eigen::Vector3d(250, -105, 32.5)));
  Eigen::Matrix3d matrix;
  matrix << 0.925417, -0.318796, -0.204874, 0.163176, 0.823173, -0.543838, 0.342020, 0.469846, 0.813798;
  EXPECT_TRUE(p.tracker_from_probe.rotation.isApprox(matrix, 1e-5));
}

// Found by fuzzing: a refusal is of station 0, and one with a whole record inside was taken for that
// station's.
TEST(Link, ARefusalWithARecordInsideIsNoReading) {
  Conversation c(test::ascii("LY"));
  c.run(1.05);
  Bytes record = test::example::stream;
  record[2] = 0;
  record[4] = 0x01;  // a command's error
  const std::uint64_t notices = c.link.counters().notices;
  c.hear(record);
  c.run(1.1);
  EXPECT_EQ(c.link.counters().notices, notices + 1);
  EXPECT_TRUE(c.readings.empty());
}

TEST(Link, EveryWayThePortIsNotOpenIsNamedAndTriedAgainEachSecond) {
  struct Case {
    PortState port;
    LinkReason reason;
  };
  constexpr Stamp start{std::chrono::seconds(1000)};
  for (const Case c : {Case{PortState::absent, LinkReason::no_device},
                       {PortState::loader, LinkReason::loader},
                       {PortState::access_denied, LinkReason::access_denied},
                       {PortState::busy, LinkReason::busy},
                       {PortState::stranger, LinkReason::stranger}}) {
    Link link{LinkConfig{}};
    int opens = 0;
    PortState port = PortState::absent;  // as nobody has looked yet
    Stamp now = start;
    while (now < start + from_seconds(3.5)) {
      const LinkOutput out = link.turn({.now = now, .port = port});
      if (out.action == LinkOutput::PortAction::open) ++opens, port = c.port;
      now = std::max(now + Duration(1), out.wake);
    }
    EXPECT_EQ(link.reason(), c.reason);
    EXPECT_EQ(opens, 4);
    link.turn({.now = now, .port = PortState::open});
    EXPECT_EQ(link.state(), LinkState::quiescing);
    EXPECT_EQ(link.reason(), LinkReason::none);
  }
}

TEST(Link, AskedToLeaveItStopsTheStreamAndCloses) {
  Conversation c(test::ascii("LY"));
  c.run(1.05);
  c.sent.clear();
  c.link.leave();
  c.run(1.5);
  EXPECT_EQ(c.sent, "P");
  EXPECT_EQ(c.link.state(), LinkState::closed);
}

}  // namespace
}  // namespace sonoband
