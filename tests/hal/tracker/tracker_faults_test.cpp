// Everything of the simulator's fault list, end to end. The rig judges every reading: no usable pose is ever
// wrong and no epoch bridges a restart. Here: the recovery happens, and the counters tell what was lost.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband {
namespace {

using sim::Fault;
using sim::FaultKind;
using test::at;
using test::Rig;

sim::LibertySimConfig with(std::vector<Fault> faults, int sensors = 1) {
  sim::LibertySimConfig config;
  config.unit.sensors = sensors;
  config.bus.bursts_per_minute = 0;
  config.faults = std::move(faults);
  return config;
}

// A second after the fault at 3 s the stream is whole again.
void expect_streams_after(Rig& rig, double until = 5) {
  rig.run(until - (seconds(rig.clock.now()) - 1000));
  EXPECT_EQ(rig.state(), DeviceState::running);
  ASSERT_FALSE(rig.samples.empty());
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::good);
  EXPECT_LT(rig.clock.now() - rig.samples.back().time, from_seconds(0.02));
}

// --- On the wire ---

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

// --- Of the unit ---

TEST(TrackerFaults, ProbesSensorUnpluggedWhileAnotherGoesOn) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::station_silent, .lasts = from_seconds(1)}}, 2));
  rig.start();
  rig.run(3.3);
  EXPECT_EQ(rig.state(), DeviceState::degraded);
  EXPECT_EQ(rig.reason(), LinkReason::probe_silent);
  EXPECT_EQ(rig.count(PoseQuality::missing), 1u);
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().recoveries, 0u);
  EXPECT_NEAR(static_cast<double>(rig.counters().lost), 240, 2);
}

TEST(TrackerFaults, AnotherSensorUnpluggedDoesNotMatter) {
  Rig rig(
      with({{.at = at(3), .kind = FaultKind::station_silent, .lasts = from_seconds(1), .station = 2}}, 2));
  rig.start();
  expect_streams_after(rig, 3.5);
  EXPECT_EQ(rig.count(PoseQuality::missing), 0u);
  EXPECT_EQ(rig.counters().recoveries, 0u);
}

TEST(TrackerFaults, OnlySensorUnpluggedForShortAndLong) {
  for (const double s : {0.1, 1.0, 20.0}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::station_silent, .lasts = from_seconds(s)}}));
    rig.start();
    rig.run(3 + 0.09);
    EXPECT_EQ(rig.count(PoseQuality::missing), 1u);
    if (s > 2) {
      rig.run(3);
      EXPECT_EQ(rig.state(), DeviceState::stalled);
      EXPECT_EQ(rig.reason(), LinkReason::probe_silent);
    }
    expect_streams_after(rig, 3 + s + 3);
  }
}

TEST(TrackerFaults, NoSensorAtStart) {
  Rig rig(with({{.at = at(0), .kind = FaultKind::station_silent, .lasts = from_seconds(30)}}));
  rig.start();
  rig.run(29);
  EXPECT_EQ(rig.reason(), LinkReason::probe_silent);
  expect_streams_after(rig, 33);
}

TEST(TrackerFaults, FirstStartsIgnored) {
  for (const int n : {1, 2}) {
    Rig rig(with({{.at = at(0), .kind = FaultKind::ignored_starts, .value = static_cast<double>(n)}}));
    rig.start();
    expect_streams_after(rig, 2.5);
    EXPECT_EQ(rig.counters().recoveries, 0u);
  }
}

TEST(TrackerFaults, StreamStopsAndIsStartedAgain) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::stream_stops}}));
  rig.start();
  rig.run(3.2);
  EXPECT_EQ(rig.count(PoseQuality::missing), 1u);
  expect_streams_after(rig, 4);
  EXPECT_EQ(rig.counters().recoveries, 1u);
  EXPECT_EQ(rig.tracker.health().recoveries, 1u);
  EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, SettingsLostNeedsConfiguring) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::settings_lost}}));
  rig.start();
  expect_streams_after(rig, 6);
  EXPECT_EQ(rig.counters().recoveries, 2u);
}

TEST(TrackerFaults, DeafUntilReset) {
  Rig rig(with({{.at = at(20), .kind = FaultKind::deaf_until_reset}}));
  rig.start();
  rig.run(20);
  expect_streams_after(rig, 27);
}

TEST(TrackerFaults, DeafUntilReinitialised) {
  Rig rig(with({{.at = at(20), .kind = FaultKind::deaf_until_reinitialise}}));
  rig.start();
  rig.run(30);
  EXPECT_EQ(rig.reason(), LinkReason::reinitialising);
  EXPECT_EQ(rig.state(), DeviceState::stalled);
  expect_streams_after(rig, 45);
}

TEST(TrackerFaults, NoReinitialisingWhileRecording) {
  Rig rig(with({{.at = at(20), .kind = FaultKind::deaf_until_reinitialise}}));
  rig.start();
  rig.run(19);
  rig.tracker.set_recording(true);
  rig.run(41);
  EXPECT_NE(rig.reason(), LinkReason::reinitialising);
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::missing);
  rig.tracker.set_recording(false);
  expect_streams_after(rig, 90);
}

TEST(TrackerFaults, DeadUnitIsAFaultAndComesBackBySelf) {
  Rig rig(with({{.at = at(20), .kind = FaultKind::deaf, .lasts = from_seconds(100)}}));
  rig.start();
  rig.run(60);
  EXPECT_EQ(rig.state(), DeviceState::fault);
  EXPECT_STREQ(rig.tracker.health().reason, operator_sentence(LinkReason::no_answer));
  expect_streams_after(rig, 140);
}

TEST(TrackerFaults, SelfTestAfterPowerUpIsWaitedFor) {
  Rig rig(with({{.at = at(0), .kind = FaultKind::deaf, .lasts = from_seconds(9)}}));
  rig.start();
  expect_streams_after(rig, 13.5);
}

// --- Left by whoever was here before ---

TEST(TrackerFaults, PoweredUpStreamingAndMisconfigured) {
  for (const bool binary : {false, true})
    for (const bool echo : {false, true}) {
      sim::LibertySimConfig config = with({});
      config.unit.sensors = 3;
      sim::LibertySettings& s = config.unit.start_up;
      s.continuous = true;
      s.binary = binary;
      s.echo = echo;
      s.rate = 3;
      s.hemisphere.fill({-1, 0, 0});
      s.boresight.fill(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()).toRotationMatrix());
      s.alignment_rotation.fill(Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()).toRotationMatrix());
      s.alignment_origin_mm.fill({10, 20, 30});
      s.tip_offset.fill({1, 2, 3});
      Rig rig(config);
      rig.start();
      expect_streams_after(rig, 3);
      EXPECT_EQ(rig.counters().recoveries, 0u);
    }
}

TEST(TrackerFaults, HalfTypedCommandSwallowsTheStop) {
  sim::LibertySimConfig config = with({});
  config.unit.start_up.continuous = true;
  Rig rig(config);
  ASSERT_EQ(rig.port.open(), PortState::open);
  const std::string half = "O1,2,";
  rig.port.write({reinterpret_cast<const std::uint8_t*>(half.data()), half.size()});
  rig.port.close(BytePort::Closing::release);
  rig.start();
  expect_streams_after(rig, 6);
  EXPECT_EQ(rig.counters().recoveries, 0u);
}

TEST(TrackerFaults, FloodAtStart) {
  Rig rig(with({{.at = at(0.05), .kind = FaultKind::flood, .value = 10000}}));
  rig.start();
  expect_streams_after(rig, 4);
}

// --- USB ---

TEST(TrackerFaults, LateArrivalsKeepTheirTimes) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::late, .lasts = from_seconds(0.04)},
                {.at = at(4), .kind = FaultKind::late, .lasts = from_seconds(0.2)}}));
  rig.start();
  expect_streams_after(rig);
  EXPECT_EQ(rig.counters().lost, 0u);
  EXPECT_EQ(rig.counters().recoveries, 0u);
}

TEST(TrackerFaults, OneStall) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::stall}}));
  rig.start();
  expect_streams_after(rig, 4);
  EXPECT_EQ(rig.counters().stalls, 1u);
  EXPECT_EQ(rig.counters().recoveries, 1u);
  EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, PersistentStallClimbsTheLadder) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::stall, .lasts = from_seconds(5)}}));
  rig.start();
  rig.run(5);
  EXPECT_EQ(rig.reason(), LinkReason::stalled);
  expect_streams_after(rig, 20);
  EXPECT_LT(rig.counters().stalls, 100u);  // no busy loop
}

TEST(TrackerFaults, IoErrors) {
  Rig few(with({{.at = at(3), .kind = FaultKind::io_error, .value = 2}}));
  few.start();
  expect_streams_after(few, 4);
  EXPECT_EQ(few.counters().io_errors, 2u);
  EXPECT_EQ(few.counters().recoveries, 0u);

  Rig many(with({{.at = at(3), .kind = FaultKind::io_error, .value = 5}}));
  many.start();
  many.run(3.3);
  EXPECT_EQ(many.reason(), LinkReason::io_error);
  expect_streams_after(many, 6);
  EXPECT_GE(many.counters().recoveries, 1u);
}

TEST(TrackerFaults, UnpluggedAndBack) {
  for (const double s : {0.2, 3.0}) {
    Rig rig(with({{.at = at(3), .kind = FaultKind::unplugged, .lasts = from_seconds(s)}}));
    rig.start();
    rig.run(3.1);
    EXPECT_EQ(rig.state(), DeviceState::absent);
    EXPECT_EQ(rig.reason(), LinkReason::no_device);
    EXPECT_EQ(rig.samples.back().quality, PoseQuality::missing);
    expect_streams_after(rig, 3 + s + 3);
    EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
  }
}

TEST(TrackerFaults, PowerCycleComesBackThroughItsLoader) {
  Rig rig(with({{.at = at(3), .kind = FaultKind::power_cycle, .lasts = from_seconds(1)}}));
  rig.start();
  rig.run(3.5);
  EXPECT_EQ(rig.tracker.link().state(), LinkState::absent);
  rig.run(1.7);
  EXPECT_EQ(rig.tracker.link().state(), LinkState::loader);
  EXPECT_EQ(rig.state(), DeviceState::fault);
  expect_streams_after(rig, 10);
  EXPECT_NE(rig.epoch(), rig.samples.front().epoch);
}

TEST(TrackerFaults, DeniedAndBusyAreNamed) {
  Rig rig(with({{.at = at(0), .kind = FaultKind::access_denied, .lasts = from_seconds(2)},
                {.at = at(0), .kind = FaultKind::busy, .lasts = from_seconds(4)}}));
  rig.start();
  rig.run(1.5);
  EXPECT_EQ(rig.state(), DeviceState::fault);
  EXPECT_EQ(rig.reason(), LinkReason::access_denied);
  rig.run(2);
  EXPECT_EQ(rig.reason(), LinkReason::busy);
  expect_streams_after(rig, 7);
}

// --- All of them ---

// Random faults for five minutes, several at a time: the rig's judgement holds throughout, and the stream is
// whole at the end.
TEST(TrackerFaults, ManyAtRandom) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<Fault> faults;
    for (double t = 3; t < 300; t += 0.2 + static_cast<double>(random() % 40) / 10) {
      Fault f{.at = at(t),
              .kind = static_cast<FaultKind>(random() % (static_cast<int>(FaultKind::busy) + 1))};
      f.lasts = from_seconds(static_cast<double>(random() % 30) / 10);
      f.value = static_cast<double>(random() % 48);
      if (f.kind == FaultKind::error_letter) f.value = "abcdefgABCDEFGIu"[random() % 16];
      if (f.kind == FaultKind::distortion) f.value = static_cast<double>(1 + random() % 2);
      if (f.kind == FaultKind::displaced) f.value = 70 + static_cast<double>(random() % 500);
      if (f.kind == FaultKind::damaged_counter) f.value = static_cast<double>(1 + random() % 100000);
      if (f.kind == FaultKind::not_finite || f.kind == FaultKind::infinite)
        f.value = static_cast<double>(random() % 7);
      if (f.kind == FaultKind::ignored_starts) f.value = static_cast<double>(1 + random() % 2);
      if (f.kind == FaultKind::io_error) f.value = static_cast<double>(1 + random() % 5);
      f.station = 1 + static_cast<int>(random() % 2);
      faults.push_back(f);
    }
    sim::LibertySimConfig config = with(std::move(faults), 2);
    config.unit.seed = seed;
    config.bus.bursts_per_minute = 10;
    config.bus.record_per_transfer = seed % 2 == 0;
    Rig rig(config);
    rig.start();
    rig.run(310);
    EXPECT_TRUE(rig.run_until_good(120)) << seed << " state " << static_cast<int>(rig.tracker.link().state())
                                         << " reason " << operator_sentence(rig.reason());
    EXPECT_GT(rig.count(PoseQuality::good), 2000u) << seed;
  }
}

}  // namespace
}  // namespace sonoband
