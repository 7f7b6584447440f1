// The VIPER end to end: simulated unit, codec, link, tracker. Every usable pose is held against the hand's.
#include <gtest/gtest.h>

#include "hal/sim/viper_sim.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband {
namespace {

using sim::Fault;
using sim::FaultKind;
using test::at;

class ViperRig {
 public:
  explicit ViperRig(const sim::ViperSimConfig& config = {}, const LinkConfig& link = {})
      : port(clock, quiet(config), test::hand), tracker(port, clock, link) {
    tracker.start();
  }

  void run_to(double s) {
    std::array<PoseSample, 64> batch;
    while (clock.now() < at(s)) {
      std::size_t n = 0;
      tracker.read(batch, n, std::min<Duration>(std::chrono::milliseconds(20), at(s) - clock.now()));
      for (std::size_t i = 0; i < n; ++i) judge(batch[i]);
    }
  }
  void expect_whole() const {
    EXPECT_EQ(tracker.health().state, DeviceState::running) << tracker.health().reason;
    ASSERT_FALSE(samples.empty());
    EXPECT_EQ(samples.back().quality, PoseQuality::good);
    EXPECT_LT(clock_now() - samples.back().time, from_seconds(0.02));
  }
  Stamp clock_now() const { return const_cast<test::SteppedClock&>(clock).now(); }

  test::SteppedClock clock;
  sim::ViperSim port;
  PolhemusTracker tracker;
  std::vector<PoseSample> samples;

 private:
  static sim::ViperSimConfig quiet(sim::ViperSimConfig config) {
    config.bus.bursts_per_minute = 0;
    return config;
  }
  void judge(const PoseSample& s) {
    if (!samples.empty()) {
      EXPECT_GT(s.time, samples.back().time);
      EXPECT_GE(s.epoch, samples.back().epoch);
    }
    samples.push_back(s);
    if (!usable(s.quality)) return;
    const auto truth = test::hand(s.time - std::chrono::milliseconds(1));
    EXPECT_LT((s.tracker_from_probe.translation - truth.translation).norm(), 0.2) << s.device_frame;
    EXPECT_LT(
        Eigen::Quaterniond(s.tracker_from_probe.rotation).angularDistance(Eigen::Quaterniond(truth.rotation)),
        0.002);
  }
};

sim::ViperSimConfig with(std::vector<Fault> faults, int sensors = 1) {
  sim::ViperSimConfig config;
  config.unit.sensors = sensors;
  config.faults = std::move(faults);
  return config;
}

TEST(ViperTracker, ComesUpAndStreams) {
  ViperRig rig;
  rig.run_to(4);
  rig.expect_whole();
  EXPECT_STREQ(rig.tracker.link().identity(), "Simulated VIPER");
  EXPECT_EQ(rig.tracker.counters().lost, 0u);
  EXPECT_EQ(rig.tracker.counters().recoveries, 0u);
  EXPECT_GT(rig.samples.size(), 240u * 3);
}

TEST(ViperTracker, LeftStreamingBySomeoneElse) {
  sim::ViperSimConfig config;
  config.unit.streams_at_start = true;
  ViperRig rig(config);
  rig.run_to(3);
  rig.expect_whole();
}

TEST(ViperTracker, ARefusedFilterIsANoticeOnly) {
  sim::ViperSimConfig config;
  config.unit.refuses_filter = true;
  ViperRig rig(config);
  rig.run_to(3);
  rig.expect_whole();
  EXPECT_EQ(rig.tracker.counters().notices, 2u);
}

TEST(ViperTracker, At120Hz) {
  ViperRig rig({}, {.rate = RecordRate::hz_120});
  rig.run_to(4);
  rig.expect_whole();
  const auto n = rig.samples.size();
  EXPECT_NEAR(seconds(rig.samples[n - 1].time - rig.samples[n - 2].time), 1.0 / 120, 1e-3);
}

TEST(ViperTracker, AByteDroppedAtEveryPlace) {
  for (int place = 0; place < 60; place += 7) {
    ViperRig rig(with({{.at = at(3), .kind = FaultKind::dropped_byte, .value = static_cast<double>(place)}}));
    rig.run_to(4);
    rig.expect_whole();
    EXPECT_EQ(rig.tracker.counters().lost, 1u) << place;
    EXPECT_EQ(rig.tracker.counters().resync_bytes, 59u) << place;
    EXPECT_EQ(rig.tracker.counters().recoveries, 0u);
  }
}

TEST(ViperTracker, EveryByteOfASizeDamaged) {
  for (int bit = 0; bit < 32; ++bit) {
    ViperRig rig(with({{.at = at(3), .kind = FaultKind::flipped_size, .value = static_cast<double>(bit)}}));
    rig.run_to(4);
    rig.expect_whole();
    EXPECT_EQ(rig.tracker.counters().lost, 1u) << bit;
    EXPECT_EQ(rig.tracker.counters().resync_bytes, 60u) << bit;
  }
}

TEST(ViperTracker, GarbageCostsNothing) {
  for (const int n : {1, 7, 60, 333, 1000}) {
    ViperRig rig(with({{.at = at(3), .kind = FaultKind::garbage, .value = static_cast<double>(n)}}));
    rig.run_to(4);
    rig.expect_whole();
    EXPECT_EQ(rig.tracker.counters().resync_bytes, static_cast<std::uint64_t>(n));
    EXPECT_EQ(rig.tracker.counters().lost, 0u);
  }
}

TEST(ViperTracker, ImpossibleValuesAreRefused) {
  ViperRig rig(with({{.at = at(3), .kind = FaultKind::not_finite, .value = 1},
                     {.at = at(3.2), .kind = FaultKind::zero_quaternion},
                     {.at = at(3.4), .kind = FaultKind::displaced, .value = 200}}));
  rig.run_to(4);
  rig.expect_whole();
  EXPECT_EQ(rig.tracker.counters().bad_values, 2u);
  EXPECT_EQ(rig.tracker.counters().jumps, 1u);
}

TEST(ViperTracker, MissingAndRepeatedFramesAreCounted) {
  ViperRig rig(with({{.at = at(3), .kind = FaultKind::missing_records, .value = 5},
                     {.at = at(3.5), .kind = FaultKind::duplicate_record}}));
  rig.run_to(4);
  rig.expect_whole();
  EXPECT_EQ(rig.tracker.counters().lost, 5u);
  EXPECT_EQ(rig.tracker.counters().duplicates, 1u);
}

TEST(ViperTracker, ACountThatWrapsGoesOnAndOneThatStepsBackIsANewEpoch) {
  ViperRig rig(with({{.at = at(2), .kind = FaultKind::counters_near_wrap, .value = 100}}));
  rig.run_to(3);
  const std::uint32_t before = rig.samples.back().epoch;
  rig.expect_whole();
  ViperRig back(with({{.at = at(3), .kind = FaultKind::counters_back, .value = 300}}));
  back.run_to(4);
  back.expect_whole();
  EXPECT_NE(back.samples.back().epoch, back.samples.front().epoch);
  rig.run_to(4);
  EXPECT_EQ(rig.samples.back().epoch, before);
}

TEST(ViperTracker, ASensorPulledAndBack) {
  ViperRig rig(with({{.at = at(3), .kind = FaultKind::station_silent, .lasts = from_seconds(1)}}, 2));
  rig.run_to(3.5);
  EXPECT_EQ(rig.tracker.health().state, DeviceState::degraded);
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::missing);
  rig.run_to(5);
  rig.expect_whole();
  EXPECT_EQ(rig.tracker.counters().recoveries, 0u);
}

TEST(ViperTracker, DistortionIsSaid) {
  ViperRig rig(
      with({{.at = at(3), .kind = FaultKind::distortion, .value = 100, .lasts = from_seconds(0.2)},
            {.at = at(3.2), .kind = FaultKind::distortion, .value = 200, .lasts = from_seconds(0.2)}}));
  rig.run_to(3.15);
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::degraded);
  rig.run_to(3.35);
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::distorted);
  rig.run_to(5);
  rig.expect_whole();
}

TEST(ViperTracker, StreamStopsSettingsLostHungUnpluggedAndStalled) {
  const Fault faults[] = {{.at = at(3), .kind = FaultKind::stream_stops},
                          {.at = at(3), .kind = FaultKind::settings_lost},
                          {.at = at(3), .kind = FaultKind::deaf_until_reset},
                          {.at = at(3), .kind = FaultKind::unplugged, .lasts = from_seconds(2)},
                          {.at = at(3), .kind = FaultKind::stall},
                          {.at = at(0), .kind = FaultKind::ignored_starts, .value = 2},
                          {.at = at(0), .kind = FaultKind::access_denied, .lasts = from_seconds(3)}};
  for (const Fault& fault : faults) {
    ViperRig rig(with({fault}));
    rig.run_to(20);
    rig.expect_whole();
    if (fault.at == at(3)) {
      EXPECT_NE(rig.samples.back().epoch, rig.samples.front().epoch) << static_cast<int>(fault.kind);
    }
  }
}

}  // namespace
}  // namespace sonoband
