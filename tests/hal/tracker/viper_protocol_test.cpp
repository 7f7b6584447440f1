#include "hal/tracker/viper_protocol.h"

#include <gtest/gtest.h>

#include "hal/tracker/little_endian.h"
#include "tests/hal/tracker/wire_support.h"

namespace sonoband {
namespace {

using namespace viper;
using test::Bytes;
using test::hex;
using test::operator+;  // NOLINT(misc-unused-using-decls): clang-tidy 14 misses operators

// The worked examples of the protocol's description.
const Bytes set_units =
    hex("56 50 52 43 20 00 00 00 00 00 00 00 07 00 00 00 00 00 00 00 ff ff ff ff 00 00 00 00 02 00 00 00 02 "
        "00 00 00 "
        "a0 42 00 00");
const Bytes get_stations =
    hex("56 50 52 43 18 00 00 00 00 00 00 00 0a 00 00 00 01 00 00 00 00 00 00 00 00 00 00 00 55 ab 00 00");
const Bytes pose =
    hex("56 50 52 50 34 00 00 00 00 00 00 00 e8 03 00 00 00 00 00 00 01 00 00 00 00 0a 00 00 00 00 c8 41 00 "
        "00 28 c1 "
        "00 00 50 40 00 00 80 3f 00 00 00 00 00 00 00 00 00 00 00 00 bd 01 00 00");

Bytes bytes_of(const WireCommand& c) {
  return {c.bytes().begin(), c.bytes().end()};
}

std::uint16_t checksum_of(const WireCommand& c) {
  return wire::load_u16(c.storage.data() + c.size - 4);
}

TEST(ViperProtocol, TheChecksumsCheckValue) {
  EXPECT_EQ(crc16(test::ascii("123456789")), 0xbb3d);
  EXPECT_EQ(crc16({}), 0);
}

TEST(ViperProtocol, CommandsAreTheExamplesToTheByte) {
  const Bytes units = hex("02000000 02000000");
  EXPECT_EQ(bytes_of(make_order(Order::units, Action::set, all_sensors, 0, units)), set_units);
  EXPECT_EQ(bytes_of(make_order(Order::station_map, Action::get)), get_stations);
  EXPECT_EQ(checksum_of(make_order(Order::single_pose, Action::get)), 0xa15f);
  EXPECT_EQ(checksum_of(make_order(Order::continuous, Action::set)), 0xf263);
  EXPECT_EQ(checksum_of(make_order(Order::continuous, Action::reset)), 0x359a);
  EXPECT_EQ(checksum_of(make_order(Order::continuous, Action::ack)), 0xf667);
  const WireCommand with_count = make_order(Order::continuous, Action::set, 0, 0, hex("00000000"));
  EXPECT_EQ(checksum_of(with_count), 0x37b5);
  EXPECT_EQ(with_count.storage[4], 0x1c);
}

std::vector<Frame> frames_of(Parser& parser, const Bytes& bytes, Stamp now = {}) {
  std::vector<Frame> all;
  parser.push(bytes, now);
  Frame frame;
  while (parser.next(frame, now, from_seconds(0.1))) all.push_back(frame);
  return all;
}

TEST(ViperProtocol, ThePoseExample) {
  Parser parser;
  const auto frames = frames_of(parser, pose);
  ASSERT_EQ(frames.size(), 1u);
  const auto header = decode_pose_header(frames[0]);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->frame, 1000u);
  EXPECT_EQ(header->self_test_error, 0);
  ASSERT_EQ(header->sensors, 1);
  const SensorPose s = decode_sensor(frames[0], 0);
  EXPECT_EQ(s.sensor, 0);
  EXPECT_FALSE(s.is_virtual);
  EXPECT_EQ(s.position_units, PositionUnits::centimetre);
  EXPECT_EQ(s.angle_units, AngleUnits::quaternion);
  EXPECT_EQ(s.distortion, 0);
  EXPECT_EQ(s.position_mm, Eigen::Vector3d(250, -105, 32.5));
  EXPECT_EQ(s.quaternion_wxyz, Eigen::Vector4d(1, 0, 0, 0));
}

TEST(ViperProtocol, FramesSplitAtEveryPlace) {
  for (std::size_t cut = 0; cut <= pose.size() + set_units.size(); ++cut) {
    Parser parser;
    const Bytes both = pose + set_units;
    auto n = frames_of(parser, {both.begin(), both.begin() + static_cast<std::ptrdiff_t>(cut)}).size();
    n += frames_of(parser, {both.begin() + static_cast<std::ptrdiff_t>(cut), both.end()}).size();
    EXPECT_EQ(n, 2u) << cut;
    EXPECT_EQ(parser.counters().resync_bytes, 0u);
  }
}

TEST(ViperProtocol, NoFlippedBitGoesUnseen) {
  for (std::size_t bit = 0; bit < 8 * pose.size(); ++bit) {
    Parser parser;
    Bytes damaged = pose;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ 1U << bit % 8);
    const auto frames = frames_of(parser, damaged + pose, Stamp{});
    // A size that grew still waits for its rest; silence ends that.
    Frame late;
    std::size_t n = frames.size();
    while (parser.next(late, Stamp{from_seconds(1)}, from_seconds(0.1))) ++n;
    EXPECT_EQ(n, 1u) << bit;
    EXPECT_EQ(parser.counters().resync_bytes, pose.size()) << bit;
    EXPECT_EQ(parser.counters().resync_events, 1u) << bit;
  }
}

TEST(ViperProtocol, SizesThatNoFrameHasAreRefusedAtOnce) {
  for (const std::uint32_t size : {0U, 1U, 4U, 23U, 51U, 53U, 0x35U, 532U + 32U, 1025U, 0xffffffffU}) {
    Parser parser;
    Bytes lie = pose;
    wire::store_u32(lie.data() + 4, size);
    EXPECT_EQ(frames_of(parser, lie + pose).size(), 1u) << size;
  }
}

TEST(ViperProtocol, ASensorCountThatIsNotTheSizeIsNoPose) {
  Bytes lie = pose;
  lie[20] = 2;
  wire::store_u32(lie.data() + 56, crc16(std::span(lie).first(56)));
  Parser parser;
  const auto frames = frames_of(parser, lie);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_FALSE(decode_pose_header(frames[0]));
}

}  // namespace
}  // namespace sonoband
