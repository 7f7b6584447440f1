// The simulator's faults of the tracker's USB, and all its faults at random, end to end. The rig judges every
// reading: no usable pose is ever wrong and no epoch bridges a restart. Here: the connection is had again.
#include <gtest/gtest.h>

#include <random>

#include "tests/hal/tracker/fault_rig.h"

namespace sonoband {
namespace {

using sim::Fault;
using sim::FaultKind;
using test::at;
using test::expect_streams_after;
using test::Rig;
using test::with;

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
