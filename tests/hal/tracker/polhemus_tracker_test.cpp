// The whole way, simulated device to readings, while nothing is wrong.
#include "hal/tracker/polhemus_tracker.h"

#include <gtest/gtest.h>

#include "tests/hal/tracker/tracker_rig.h"
#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

using test::Rig;

TEST(PolhemusTracker, ConnectsAndStreams) {
  Rig rig;
  EXPECT_EQ(rig.state(), DeviceState::absent);
  rig.start();
  rig.run(0.1);
  EXPECT_EQ(rig.state(), DeviceState::starting);
  rig.run(4.9);
  EXPECT_EQ(rig.state(), DeviceState::running);
  EXPECT_STREQ(rig.tracker.health().reason, "");
  // A second to connect and settle, then 240 a second.
  EXPECT_GT(rig.samples.size(), 240u * 3);
  EXPECT_EQ(rig.count(PoseQuality::good), rig.samples.size());
  EXPECT_EQ(rig.tracker.health().delivered, rig.samples.size());
  EXPECT_EQ(rig.counters().lost, 0u);
  EXPECT_EQ(rig.counters().resync_bytes, 0u);
  EXPECT_EQ(rig.counters().recoveries, 0u);
  EXPECT_STREQ(rig.tracker.link().identity(), "Simulated LIBERTY");
}

TEST(PolhemusTracker, ReadTakesNoHeap) {
  sim::LibertySimConfig config;
  config.faults = {{.at = test::at(2), .kind = sim::FaultKind::garbage, .value = 500},
                   {.at = test::at(3), .kind = sim::FaultKind::unplugged, .lasts = from_seconds(0.5)}};
  Rig rig(config);
  rig.start();
  std::array<PoseSample, 16> batch;
  std::size_t n = 0;
  std::size_t all = 0;
  const test::AllocationCounter allocations;
  while (rig.clock.now() < test::at(7)) {
    rig.tracker.read(batch, n, std::chrono::milliseconds(10));
    all += n;
  }
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_GT(all, 500u);
}

TEST(PolhemusTracker, StopLeavesTheUnitQuiet) {
  Rig rig;
  rig.start();
  rig.run(2);
  rig.tracker.stop();
  EXPECT_EQ(rig.state(), DeviceState::absent);
  PoseSample sample;
  std::size_t n = 1;
  EXPECT_EQ(rig.tracker.read({&sample, 1}, n, Duration(0)), ReadStatus::ended);
  EXPECT_EQ(n, 0u);
  ASSERT_EQ(rig.port.open(), PortState::open);
  std::array<std::uint8_t, 4096> bytes{};
  EXPECT_EQ(rig.port.read(bytes, from_seconds(1)).count, 0u);
}

TEST(PolhemusTracker, EpochsGoOnAfterStopAndStart) {
  Rig rig;
  rig.start();
  rig.run(2);
  const std::uint32_t before = rig.epoch();
  rig.tracker.stop();
  rig.start();
  rig.run(2);
  EXPECT_GT(rig.epoch(), before);
}

TEST(PolhemusTracker, PatriotAt60Hz) {
  sim::LibertySimConfig config;
  config.unit.model = sim::TrackerModel::patriot;
  Rig rig(config);
  rig.start();
  rig.run(6);
  EXPECT_EQ(rig.state(), DeviceState::running);
  EXPECT_GT(rig.samples.size(), 60u * 4);
  EXPECT_EQ(rig.counters().lost, 0u);
  EXPECT_EQ(rig.counters().recoveries, 0u);
}

TEST(PolhemusTracker, HalfRate) {
  Rig rig({}, {.rate = RecordRate::hz_120});
  rig.start();
  rig.run(2);
  const std::size_t before = rig.samples.size();
  rig.run(2);
  EXPECT_NEAR(static_cast<double>(rig.samples.size() - before), 240, 8);
}

TEST(PolhemusTracker, OnlyTheProbesStationIsHandedOut) {
  sim::LibertySimConfig config;
  config.unit.sensors = 4;
  Rig rig(config);
  rig.start();
  rig.run(3);
  EXPECT_EQ(rig.state(), DeviceState::running);
  EXPECT_GT(rig.samples.size(), 240u);
  EXPECT_GT(rig.counters().readings, 3 * rig.samples.size());

  Rig second(config, {.probe_station = 2});
  second.tracker.start();
  std::array<PoseSample, 64> batch;
  std::size_t n = 0;
  while (n == 0 && second.clock.now() < test::at(3))
    second.tracker.read(batch, n, std::chrono::milliseconds(20));
  ASSERT_GT(n, 0u);
  EXPECT_TRUE(batch[0].tracker_from_probe.translation.isApprox(Eigen::Vector3d(300, 80, 100), 1e-3));
}

TEST(PolhemusTracker, SixteenStations) {
  sim::LibertySimConfig config;
  config.unit.sensors = 16;
  Rig rig(config);
  rig.start();
  rig.run(3);
  EXPECT_EQ(rig.state(), DeviceState::running);
  EXPECT_EQ(rig.counters().resync_bytes, 0u);
}

TEST(PolhemusTracker, EverySplitOfARecord) {
  for (std::size_t split = 1; split < 48; ++split) {
    sim::LibertySimConfig config;
    config.bus.split_at = split;
    config.unit.sensors = 1 + static_cast<int>(split % 2);
    Rig rig(config);
    rig.start();
    rig.run(1.6);
    EXPECT_GT(rig.samples.size(), 80u) << split;
    EXPECT_EQ(rig.counters().lost, 0u) << split;
    EXPECT_EQ(rig.counters().resync_bytes, 0u) << split;
  }
}

TEST(PolhemusTracker, FullSpeedPacketsZeroLengthOnesAndLateStatus) {
  sim::LibertySimConfig config;
  config.bus.max_packet = 64;
  config.bus.record_per_transfer = false;
  config.bus.zero_length = 0.1;
  config.bus.late_status = 0.3;
  config.bus.bursts_per_minute = 60;
  config.unit.sensors = 3;
  Rig rig(config);
  rig.start();
  rig.run(5);
  EXPECT_GT(rig.samples.size(), 240u * 3);
  EXPECT_EQ(rig.counters().resync_bytes, 0u);
  EXPECT_EQ(rig.counters().lost, 0u);
}

TEST(PolhemusTracker, DriftOfTheUnitsClockIsFollowed) {
  for (const double ppm : {-50.0, 50.0}) {
    sim::LibertySimConfig config;
    config.unit.clock_drift_ppm = ppm;
    Rig rig(config);
    rig.start();
    rig.run(20);
    EXPECT_EQ(rig.counters().doubtful, 0u);
    EXPECT_EQ(rig.counters().recoveries, 0u);
    EXPECT_LT(rig.worst_mm, 0.1);
  }
}

// A slow reader of the newest-only FIFO sees gaps, never old poses.
TEST(PolhemusTracker, SlowReaderLosesRecordsAndCountsThem) {
  Rig rig;
  rig.start();
  rig.run(2);
  const std::size_t before = rig.samples.size();
  for (int i = 0; i < 20; ++i) {
    rig.clock.sleep_until(rig.clock.now() + from_seconds(0.1));
    rig.run(0.02);
  }
  EXPECT_GT(rig.counters().lost, 200u);
  EXPECT_GT(rig.samples.size(), before + 20);
  EXPECT_EQ(rig.counters().recoveries, 0u);
}

}  // namespace
}  // namespace sonoband
