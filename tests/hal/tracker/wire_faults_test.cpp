// The simulator's faults on the wire, end to end. The rig judges every reading: no usable pose is ever wrong
// and no epoch bridges a restart. Here: the stream goes on, and the counters tell what was lost.
#include <gtest/gtest.h>

#include <string>

#include "tests/hal/tracker/fault_rig.h"

namespace sonoband {
namespace {

using sim::FaultKind;
using test::at;
using test::expect_streams_after;
using test::Rig;
using test::with;

TEST(TrackerFaults, GarbageOfEveryLength) {
  for (const int n : {1, 2, 3, 7, 8, 9, 40, 47, 48, 49, 100, 333, 512, 999, 1000}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::garbage, .value = static_cast<double>(n)}}));
    rig.start();
    expect_streams_after(rig);
    EXPECT_EQ(rig.counters().resync_bytes, static_cast<std::uint64_t>(n)) << n;
    EXPECT_EQ(rig.counters().resync_events, 1u) << n;
    EXPECT_EQ(rig.counters().lost, 0u) << n;
    EXPECT_EQ(rig.counters().recoveries, 0u) << n;
  }
}

TEST(TrackerFaults, AByteDroppedAtEveryPlace) {
  for (int place = 0; place < 48; ++place) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::dropped_byte, .value = static_cast<double>(place)}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_GE(rig.counters().lost, 1u) << place;
    EXPECT_LE(rig.counters().lost, 2u) << place;
    EXPECT_EQ(rig.counters().recoveries, 0u) << place;
    EXPECT_EQ(rig.epoch(), rig.samples.front().epoch) << place;
  }
}

TEST(TrackerFaults, EveryBitOfASizeFlipped) {
  for (int bit = 0; bit < 16; ++bit) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::flipped_size, .value = static_cast<double>(bit)}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_EQ(rig.counters().lost, 1u) << bit;
    EXPECT_EQ(rig.counters().resync_bytes, 48u) << bit;
    EXPECT_EQ(rig.epoch(), rig.samples.front().epoch) << bit;
  }
}

TEST(TrackerFaults, WrongListForAWhile) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::wrong_list, .lasts = from_seconds(3)}}));
  rig.start();
  rig.run(4.5);
  EXPECT_NE(rig.state(), DeviceState::running);
  EXPECT_GE(rig.counters().recoveries, 1u);
  expect_streams_after(rig, 12);
  EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, NotFiniteValues) {
  for (int place = 0; place < 7; ++place)
    for (const FaultKind kind : {FaultKind::not_finite, FaultKind::infinite}) {
      Rig rig(with({{.at = at(3), .kind = kind, .value = static_cast<double>(place)}}));
      rig.start();
      expect_streams_after(rig, 4);
      EXPECT_EQ(rig.counters().bad_values, 1u);
      EXPECT_EQ(rig.counters().lost, 1u);
    }
}

TEST(TrackerFaults, ZeroQuaternion) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::zero_quaternion}}));
  rig.start();
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().bad_values, 1u);
}

TEST(TrackerFaults, QuaternionOfTheOtherSignIsTheSamePose) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::negated_quaternion, .lasts = from_seconds(0.5)}}));
  rig.start();
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().bad_values + rig.counters().jumps + rig.counters().lost, 0u);
  EXPECT_EQ(rig.count(PoseQuality::good), rig.samples.size());
}

TEST(TrackerFaults, MirroredPosesAreNotUsable) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::mirrored, .lasts = from_seconds(0.8)}}));
  rig.start();
  rig.run(3.4);
  EXPECT_EQ(rig.state(), DeviceState::degraded);
  EXPECT_EQ(rig.reason(), LinkReason::mirrored);
  expect_streams_after(rig, 5);
  EXPECT_NEAR(static_cast<double>(rig.counters().mirrored), 0.8 * 240, 2);
  EXPECT_EQ(rig.count(PoseQuality::outside), rig.counters().mirrored);
}

TEST(TrackerFaults, MirroredFromTheFirstReadingOn) {
  Rig rig(with({{.at = at(0), .kind = FaultKind::mirrored, .lasts = from_seconds(3)}}));
  rig.start();
  rig.run(2.9);
  EXPECT_EQ(rig.reason(), LinkReason::mirrored);
  EXPECT_EQ(rig.count(PoseQuality::good), 0u);
  expect_streams_after(rig, 4);
}

TEST(TrackerFaults, SilentDamageOfAPosition) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::displaced, .value = 60}}));
  rig.start();
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().jumps, 1u);
  EXPECT_EQ(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, Distortion) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::distortion, .value = 1, .lasts = from_seconds(0.5)},
                {.at = at(5), .kind = FaultKind::distortion, .value = 2, .lasts = from_seconds(0.5)}}));
  rig.start();
  rig.run(3.3);
  EXPECT_EQ(rig.reason(), LinkReason::some_distortion);
  rig.run(2);
  EXPECT_EQ(rig.state(), DeviceState::degraded);
  EXPECT_EQ(rig.reason(), LinkReason::high_distortion);
  expect_streams_after(rig, 7);
  EXPECT_NEAR(static_cast<double>(rig.count(PoseQuality::degraded)), 120, 2);
  EXPECT_NEAR(static_cast<double>(rig.count(PoseQuality::distorted)), 120, 2);
}

TEST(TrackerFaults, EveryErrorLetter) {
  for (const char letter : std::string("abcdefgABCDEFGIu")) {
    Rig rig(with({{.at = at(3),
                   .kind = FaultKind::error_letter,
                   .value = static_cast<double>(letter),
                   .lasts = from_seconds(0.1)}}));
    rig.start();
    rig.run(3.09);
    const PoseQuality expected = letter == 'I'   ? PoseQuality::degraded
                                 : letter == 'u' ? PoseQuality::outside
                                                 : PoseQuality::fault;
    EXPECT_NEAR(static_cast<double>(rig.count(expected)), 20, 2) << letter;
    EXPECT_EQ(rig.state(), expected == PoseQuality::fault ? DeviceState::fault : DeviceState::degraded);
    expect_streams_after(rig, 4);
    EXPECT_EQ(rig.counters().last_error, letter);
  }
}

TEST(TrackerFaults, TextsBetweenRecords) {
  for (const int code : {0x01, 0x12, 0x14, 0x17, 0x18}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::error_text, .value = static_cast<double>(code)}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_EQ(rig.counters().notices, 1u) << code;
    EXPECT_EQ(rig.counters().lost, 0u) << code;
    EXPECT_EQ(rig.counters().recoveries, 0u) << code;
  }
}

TEST(TrackerFaults, DuplicateRecord) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::duplicate_record}}));
  rig.start();
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().duplicates, 1u);
  EXPECT_EQ(rig.counters().lost, 0u);
}

TEST(TrackerFaults, MissingRecordsAreCounted) {
  for (const int n : {1, 2, 10, 40}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::missing_records, .value = static_cast<double>(n)}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_EQ(rig.counters().lost, static_cast<std::uint64_t>(n));
    EXPECT_EQ(rig.tracker.health().lost, static_cast<std::uint64_t>(n));
    EXPECT_EQ(rig.epoch(), rig.samples.front().epoch);
    EXPECT_EQ(rig.count(PoseQuality::missing), n > 12 ? 1u : 0u) << n;
  }
}

TEST(TrackerFaults, OneDamagedCountIsNoEpoch) {
  for (const double off : {5.0, -5.0, 500.0, 1e6, -1e6}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::damaged_counter, .value = off}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_EQ(rig.counters().doubtful, 1u) << off;
    EXPECT_EQ(rig.counters().lost, 1u) << off;
    EXPECT_EQ(rig.epoch(), rig.samples.front().epoch) << off;
  }
}

TEST(TrackerFaults, CountersThatStepBackAreANewEpoch) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::counters_back, .value = 100}}));
  rig.start();
  expect_streams_after(rig, 4);
  EXPECT_EQ(rig.counters().doubtful, 1u);
  EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, CountersThatStepBackALittleAreSeenToo) {
  for (const double n : {1.0, 2.0, 3.0}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::counters_back, .value = n}}));
    rig.start();
    expect_streams_after(rig, 4);
    EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
  }
}

TEST(TrackerFaults, CountersWrap) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::counters_near_wrap, .value = 200}}));
  rig.start();
  rig.run(3.5);
  const std::uint32_t epoch = rig.epoch();
  EXPECT_NE(epoch, rig.samples.front().epoch);
  EXPECT_GT(rig.samples.back().device_frame, 0xffffff00U);
  EXPECT_GT(rig.samples.back().device_ms, 0xfffff000U);
  expect_streams_after(rig, 5);
  EXPECT_EQ(rig.epoch(), epoch);
  EXPECT_LT(rig.samples.back().device_frame, 1000u);
  EXPECT_LT(rig.samples.back().device_ms, 5000u);
  EXPECT_EQ(rig.counters().lost, 0u);
}

TEST(TrackerFaults, FloodInTheStream) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::flood, .value = 20000}}));
  rig.start();
  expect_streams_after(rig, 8);
  EXPECT_GT(rig.counters().resync_bytes, 19000u);
}

}  // namespace
}  // namespace sonoband
