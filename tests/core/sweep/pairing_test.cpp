#include "core/sweep/pairing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

using std::chrono::milliseconds;

Stamp at_ms(double ms) {
  return Stamp(from_seconds(ms / 1000));
}

PoseSample reading(double ms, double x_mm) {
  PoseSample s;
  s.time = at_ms(ms);
  s.tracker_from_probe.translation = {x_mm, 0, 0};
  s.quality = PoseQuality::good;
  return s;
}

TEST(Pairing, FrameWaitsForThePoseAfterItAndNoLonger) {
  PoseTrack track(8);
  Pairing pairing({});
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(pairing.push({7, at_ms(2), at_ms(3)}));
  EXPECT_FALSE(pairing.pop(track, at_ms(3)));
  ASSERT_TRUE(track.add(reading(4, 4)));
  const auto paired = pairing.pop(track, at_ms(5));
  ASSERT_TRUE(paired);
  EXPECT_EQ(paired->ticket, 7U);
  EXPECT_EQ(paired->captured, at_ms(2));
  EXPECT_EQ(paired->pose.status, PoseStatus::ok);
  EXPECT_NEAR(paired->pose.tracker_from_probe.translation.x(), 2, 1e-9);
  EXPECT_EQ(pairing.waiting(), 0U);
}

TEST(Pairing, TheWaitIsBounded) {
  PoseTrack track(8);
  Pairing pairing({.wait = milliseconds(100)});
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(pairing.push({1, at_ms(2), at_ms(10)}));
  EXPECT_FALSE(pairing.pop(track, at_ms(109.9)));
  const auto paired = pairing.pop(track, at_ms(110));
  ASSERT_TRUE(paired);
  EXPECT_EQ(paired->pose.status, PoseStatus::not_yet);
}

TEST(Pairing, OrderIsKeptAndThePoseMayComeOnTheLastMoment) {
  PoseTrack track(8);
  Pairing pairing({});
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(pairing.push({1, at_ms(2), at_ms(2)}));
  ASSERT_TRUE(pairing.push({2, at_ms(30), at_ms(30)}));
  ASSERT_TRUE(track.add(reading(40, 40)));
  const auto first = pairing.pop(track, at_ms(200));
  const auto second = pairing.pop(track, at_ms(200));
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->ticket, 1U);
  EXPECT_EQ(second->ticket, 2U);
  EXPECT_EQ(first->pose.status, PoseStatus::ok);
  EXPECT_EQ(second->pose.status, PoseStatus::ok);
}

TEST(Pairing, AFullQueuePushesTheOldestOut) {
  PoseTrack track(8);
  Pairing pairing({.capacity = 3});
  for (std::uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(pairing.push({i, at_ms(i), at_ms(i)}));
  EXPECT_FALSE(pairing.push({9, at_ms(9), at_ms(9)}));
  const auto oldest = pairing.pop(track, at_ms(3));
  ASSERT_TRUE(oldest);
  EXPECT_EQ(oldest->ticket, 0U);
  EXPECT_EQ(oldest->pose.status, PoseStatus::not_yet);
  EXPECT_FALSE(pairing.pop(track, at_ms(3)));
  EXPECT_EQ(pairing.pop_now(track)->ticket, 1U);
}

TEST(Pairing, TheReasonIsHandedOn) {
  PoseTrack track(8);
  Pairing pairing({});
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(track.add(reading(90, 0)));
  ASSERT_TRUE(pairing.push({1, at_ms(2), at_ms(2)}));
  EXPECT_EQ(pairing.pop(track, at_ms(91))->pose.status, PoseStatus::gap);
}

// The probe moves at 50 mm/s. A fixed wire shows in every picture at the probe's true distance from it, but
// the picture reaches the host 120 ms after the moment it shows and the reading of the tracker 15 ms after.
// Only the right sign and size of the offset put the wire in one place: the wrong sign is off by 10.5 mm.
TEST(Pairing, LatencyOffsetPutsAMovingProbesPictureWhereItWasTaken) {
  constexpr double speed_mm_per_ms = 0.05;
  constexpr double scanner_ms = 120;
  constexpr double tracker_ms = 15;
  const auto probe_x = [](double true_ms) { return 3 + speed_mm_per_ms * true_ms; };
  constexpr double wire_x = 30;

  PairingSettings settings;
  settings.latency_offset = from_seconds(scanner_ms / 1000) - from_seconds(tracker_ms / 1000);
  Pairing pairing(settings);
  PoseTrack track(1024);
  for (double true_ms = 0; true_ms < 800; true_ms += 1000.0 / 240)
    ASSERT_TRUE(track.add(reading(true_ms + tracker_ms, probe_x(true_ms))));
  int seen = 0;
  for (double true_ms = 100; true_ms < 600; true_ms += 40) {
    const double in_picture = wire_x - probe_x(true_ms);
    ASSERT_TRUE(pairing.push({0, at_ms(true_ms + scanner_ms), at_ms(true_ms + scanner_ms)}));
    const auto paired = pairing.pop(track, at_ms(true_ms + scanner_ms));
    ASSERT_TRUE(paired);
    ASSERT_EQ(paired->pose.status, PoseStatus::ok);
    EXPECT_NEAR(paired->pose.tracker_from_probe.translation.x() + in_picture, wire_x, 1e-6);
    ++seen;
  }
  EXPECT_EQ(seen, 13);
}

TEST(Pairing, TakesNoHeap) {
  PoseTrack track(16);
  Pairing pairing({});
  const test::AllocationCounter allocations;
  for (std::uint32_t i = 0; i < 100; ++i) {
    ASSERT_TRUE(pairing.push({i, at_ms(33.0 * i), at_ms(33.0 * i)}));
    ASSERT_TRUE(track.add(reading(33.0 * i + 1, 0)));
    ASSERT_TRUE(pairing.pop(track, at_ms(33.0 * i + 1)));
  }
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace sonoband
