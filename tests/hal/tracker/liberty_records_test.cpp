// The worked examples of the protocol's description, decoded; and what damaged values are called.
#include "hal/tracker/liberty_records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hal/tracker/little_endian.h"
#include "tests/hal/tracker/wire_support.h"

namespace sonoband::liberty {
namespace {

using test::Bytes;
using test::operator+;  // NOLINT(misc-unused-using-decls): clang-tidy 14 misses operators

Packet packet(const Bytes& bytes) {
  return {.tag = static_cast<Tag>(wire::load_u16(bytes.data())),
          .station = bytes[2],
          .command = bytes[3],
          .error = bytes[4],
          .body = std::span(bytes).subspan(header_bytes),
          .arrived = {}};
}

const OutputList default_list{Item::position, Item::angles, Item::crlf};
const OutputList other_list{Item::position,    Item::quaternion, Item::time_ms,
                            Item::frame_count, Item::distortion, Item::sync};

TEST(LibertyRecords, StreamRecord) {
  const auto r = decode_record(packet(test::example::stream), tracking_list, Units::centimetres);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->station, 1);
  EXPECT_EQ(r->error, 0);
  EXPECT_EQ(r->time_ms, 4u);
  EXPECT_EQ(r->frame, 1u);
  EXPECT_EQ(r->distortion, 0);
  EXPECT_EQ(*r->position_mm, Eigen::Vector3d(250, -105, 32.5));
  EXPECT_TRUE(r->quaternion_wxyz->isApprox(Eigen::Vector4d(0.943714, 0.268536, -0.144878, 0.127679), 1e-6));
  EXPECT_FALSE(r->angles_deg);
  EXPECT_FALSE(r->sync);
  EXPECT_EQ(check_values(*r), ValueFault::none);
}

TEST(LibertyRecords, PatriotRecord) {
  const auto r = decode_record(packet(test::example::patriot), tracking_list, Units::centimetres);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->time_ms, 123456u);
  EXPECT_EQ(r->frame, 29629u);
  EXPECT_TRUE(r->quaternion_wxyz->isApprox(Eigen::Vector4d(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), 1e-7));
}

TEST(LibertyRecords, OtherListWithSync) {
  const auto r = decode_record(packet(test::example::other_list), other_list, Units::inches);
  ASSERT_TRUE(r);
  EXPECT_EQ(*r->position_mm, Eigen::Vector3d(635, -266.7, 82.55));
  EXPECT_EQ(*r->quaternion_wxyz, Eigen::Vector4d(1, 0, 0, 0));
  EXPECT_EQ(r->time_ms, 123456u);
  EXPECT_EQ(r->frame, 29629u);
  EXPECT_EQ(r->sync, 0);
}

TEST(LibertyRecords, PollWithAngles) {
  Bytes bytes = test::example::poll;
  for (const std::uint8_t no_error : {0x00, 0x20}) {
    bytes[4] = no_error;
    const auto r = decode_record(packet(bytes), default_list, Units::centimetres);
    ASSERT_TRUE(r);
    EXPECT_EQ(*r->position_mm, Eigen::Vector3d(10, 20, -30));
    EXPECT_EQ(*r->angles_deg, Eigen::Vector3d(10, -20, 30));
    EXPECT_EQ(classify(r->error), ErrorKind::none);
  }
}

TEST(LibertyRecords, WrongSizeForTheListIsRefused) {
  EXPECT_FALSE(decode_record(packet(test::example::stream), default_list, Units::centimetres));
  EXPECT_FALSE(decode_record(packet(test::example::poll), tracking_list, Units::centimetres));
}

TEST(LibertyRecords, AnglesToQuaternionAndMatrix) {
  const Eigen::Quaterniond q = quaternion_from_angles({10, -20, 30});
  EXPECT_TRUE(q.isApprox(Eigen::Quaterniond(0.943714, 0.268536, -0.144878, 0.127679), 1e-6));
  Eigen::Matrix3d matrix;
  matrix << 0.925417, -0.318796, -0.204874, 0.163176, 0.823173, -0.543838, 0.342020, 0.469846, 0.813798;
  EXPECT_TRUE(q.toRotationMatrix().isApprox(matrix, 1e-6)) << q.toRotationMatrix();
  EXPECT_TRUE(
      quaternion_from_angles({90, 0, 0}).isApprox(Eigen::Quaterniond(0.707107, 0, 0, 0.707107), 1e-6));
  EXPECT_TRUE(
      quaternion_from_angles({0, 45, 0}).isApprox(Eigen::Quaterniond(0.923880, 0, 0.382683, 0), 1e-6));
  EXPECT_TRUE(quaternion_from_angles({0, 0, -60}).isApprox(Eigen::Quaterniond(0.866025, -0.5, 0, 0), 1e-6));
}

TEST(LibertyRecords, ValueFaults) {
  const Record good = *decode_record(packet(test::example::stream), tracking_list, Units::centimetres);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Record r = good;
  (*r.position_mm)[1] = nan;
  EXPECT_EQ(check_values(r), ValueFault::not_finite);
  r = good;
  (*r.quaternion_wxyz)[3] = infinity;
  EXPECT_EQ(check_values(r), ValueFault::not_finite);
  r = good;
  r.angles_deg = Eigen::Vector3d(0, nan, 0);
  EXPECT_EQ(check_values(r), ValueFault::not_finite);
  r = good;
  (*r.position_mm)[2] = -5000.1;
  EXPECT_EQ(check_values(r), ValueFault::too_far);
  (*r.position_mm)[2] = -5000;
  EXPECT_EQ(check_values(r), ValueFault::none);
  r = good;
  r.quaternion_wxyz = Eigen::Vector4d::Zero();
  EXPECT_EQ(check_values(r), ValueFault::bad_quaternion);
  r = good;
  *r.quaternion_wxyz *= 1.0101 / good.quaternion_wxyz->norm();
  EXPECT_EQ(check_values(r), ValueFault::bad_quaternion);
  r = good;
  r.distortion = 3;
  EXPECT_EQ(check_values(r), ValueFault::bad_distortion);
}

// A byte lost inside a record moves the next record's tag into the last float: with the quaternion last, its
// value leaves every range. So a record short of one or two bytes is never taken for a pose.
TEST(LibertyRecords, AByteLostAnywhereInTheBodyIsSeen) {
  const Bytes two = test::example::stream + test::example::stream;
  for (std::size_t lost = header_bytes; lost < 48; ++lost)
    for (const std::size_t n : {1u, 2u}) {
      Bytes bytes = two;
      bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(lost),
                  bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(lost + n, 48)));
      bytes.resize(48);
      const auto r = decode_record(packet(bytes), tracking_list, Units::centimetres);
      ASSERT_TRUE(r);
      EXPECT_NE(check_values(*r), ValueFault::none) << n << " at " << lost;
    }
}

TEST(LibertyReplies, Stations) {
  const auto map = decode_stations(packet(test::example::stations));
  ASSERT_TRUE(map);
  EXPECT_TRUE(map->usable(1));
  EXPECT_FALSE(map->usable(2));
  EXPECT_FALSE((StationMap{.detected = 3, .active = 1}.usable(2)));
  EXPECT_TRUE((StationMap{.detected = 0x8000, .active = 0xffff}.usable(16)));
  EXPECT_FALSE(decode_stations(packet(test::example::stream)));
}

TEST(LibertyReplies, Numbers) {
  EXPECT_EQ(decode_number(packet(test::example::units)), 1);
  EXPECT_FALSE(decode_number(packet(test::example::error_reply)));
}

TEST(LibertyReplies, OutputLists) {
  const Bytes tracking = test::hex(
      "4c 59 01 4f 00 00 18 00 08 00 00 00 09 00 00 00 0b 00 00 00 03 00 00 00 07 00 00 00 ff ff ff ff");
  EXPECT_EQ(decode_output_list(packet(tracking)), tracking_list);
  Bytes no_end = tracking;
  no_end.resize(28);
  EXPECT_FALSE(decode_output_list(packet(no_end)));
  Bytes no_item = tracking;
  no_item[8] = 13;
  EXPECT_FALSE(decode_output_list(packet(no_item)));
  const Bytes endless = tracking + Bytes(4 * 100, 0);
  EXPECT_EQ(decode_output_list(packet(endless)), tracking_list);
  EXPECT_FALSE(decode_output_list(packet(Bytes(8) + Bytes(4 * 21, 0))));
}

TEST(LibertyReplies, Filters) {
  const Bytes off = test::hex("4c 59 00 58 00 00 10 00 00 00 00 00 00 00 80 3f 00 00 00 00 00 00 00 00");
  const auto filter = decode_filter(packet(off));
  ASSERT_TRUE(filter);
  EXPECT_EQ(*filter, (std::array<float, 4>{0, 1, 0, 0}));
  EXPECT_FALSE(decode_filter(packet(test::example::units)));
  const Bytes facing_down = test::hex("4c 59 01 48 00 00 0c 00 00 00 00 00 00 00 00 00 00 00 80 3f");
  EXPECT_EQ(decode_vector(packet(facing_down)), (std::array<float, 3>{0, 0, 1}));
}

TEST(LibertyReplies, Identity) {
  const Bytes reply =
      test::hex("4c 59 00 16 00 00 22 00 04 00 00") + test::ascii("\r\nPolhemus LIBERTY\r\nVer 1.0\r\n  ");
  const auto identity = decode_identity(packet(reply));
  ASSERT_TRUE(identity);
  EXPECT_EQ(identity->tag, Tag::liberty);
  EXPECT_EQ(identity->stations, 4);
  EXPECT_STREQ(identity->text.data(), "Polhemus LIBERTY");
  // Any length, any bytes.
  const auto longest = decode_identity(packet(Bytes(8 + 3) + Bytes(500, 'x')));
  ASSERT_TRUE(longest);
  EXPECT_EQ(std::string(longest->text.data()).size(), 63u);
  EXPECT_FALSE(decode_identity(packet(Bytes(8 + 2))));
}

TEST(LibertyErrors, EveryDocumentedLetterHasItsKind) {
  for (const char c : std::string("abcdefgABCDEFG"))
    EXPECT_EQ(classify(static_cast<std::uint8_t>(c)), ErrorKind::source_fault) << c;
  EXPECT_EQ(classify('I'), ErrorKind::self_test);
  EXPECT_EQ(classify('u'), ErrorKind::outside_map);
  EXPECT_EQ(classify(0), ErrorKind::none);
  EXPECT_EQ(classify(' '), ErrorKind::none);
  for (int e = 0x01; e <= 0x07; ++e)
    EXPECT_EQ(classify(static_cast<std::uint8_t>(e)), ErrorKind::configuration) << e;
  for (int e = 0x08; e <= 0x0f; ++e)
    EXPECT_EQ(classify(static_cast<std::uint8_t>(e)), ErrorKind::hardware) << e;
  EXPECT_EQ(classify(0x16), ErrorKind::hardware);
  for (const int e : {0x12, 0x14, 0x17, 0x18})
    EXPECT_EQ(classify(static_cast<std::uint8_t>(e)), ErrorKind::notice) << e;
  EXPECT_EQ(classify(0x99), ErrorKind::unknown);
  EXPECT_STREQ(error_text(0x01), "invalid command");
  EXPECT_STREQ(error_text('c'), "source failure on X and Y");
}

}  // namespace
}  // namespace sonoband::liberty
