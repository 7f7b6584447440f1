// The simulator's faults of the tracker's unit, and what it was left in by whoever was here before, end to
// end. The rig judges every reading: no usable pose is ever wrong and no epoch bridges a restart. Here: it
// comes back.
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
  rig.run(6);
  EXPECT_EQ(rig.reason(), LinkReason::waking) << "nobody should switch it off now";
  EXPECT_EQ(rig.state(), DeviceState::starting);
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

}  // namespace
}  // namespace sonoband
