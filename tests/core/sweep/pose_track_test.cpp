#include "core/sweep/pose_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/allocation_counter.h"
#include "tests/support/support.h"

namespace sonoband {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

Stamp at_ms(double ms) {
  return Stamp(from_seconds(ms / 1000));
}

PoseSample reading(double ms, double x_mm, double turn_rad = 0, PoseQuality quality = PoseQuality::good,
                   std::uint32_t epoch = 1) {
  PoseSample s;
  s.time = at_ms(ms);
  s.tracker_from_probe.rotation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  s.tracker_from_probe.translation = {x_mm, 0, 0};
  s.quality = quality;
  s.epoch = epoch;
  return s;
}

double turn_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

TEST(PoseTrack, InterpolatesPositionAndTurnInProportion) {
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(0, 10, 0.2)));
  ASSERT_TRUE(track.add(reading(4, 14, 0.6)));
  const PoseAt pose = track.pose_at(at_ms(1));
  ASSERT_EQ(pose.status, PoseStatus::ok);
  EXPECT_NEAR(pose.tracker_from_probe.translation.x(), 11, 1e-12);
  EXPECT_NEAR(turn_between(pose.tracker_from_probe.rotation, reading(0, 0, 0.3).tracker_from_probe.rotation),
              0, 1e-7);
}

TEST(PoseTrack, TurnsTheShortWayWhereTheQuaternionChangesSign) {
  // A matrix turned by a little under and a little over 180 degrees gives quaternions of opposite sign.
  PoseTrack track(8);
  const double pi = std::acos(-1.0);
  ASSERT_TRUE(track.add(reading(0, 0, pi - 0.1)));
  ASSERT_TRUE(track.add(reading(4, 0, pi + 0.1)));
  const PoseAt pose = track.pose_at(at_ms(1));
  ASSERT_EQ(pose.status, PoseStatus::ok);
  EXPECT_NEAR(
      turn_between(pose.tracker_from_probe.rotation, reading(0, 0, pi - 0.05).tracker_from_probe.rotation), 0,
      1e-7);
}

TEST(PoseTrack, LiesBetweenItsReadingsWhateverTheyAre) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-100, 100);
  std::uniform_real_distribution<double> fraction(0.02, 0.98);
  for (int i = 0; i < 300; ++i) {
    PoseSample a = reading(0, 0);
    PoseSample b = reading(10, 0);
    a.tracker_from_probe = {test::random_rotation(random), {any(random), any(random), any(random)}};
    b.tracker_from_probe = {test::random_rotation(random), {any(random), any(random), any(random)}};
    PoseTrack track(4);
    ASSERT_TRUE(track.add(a) && track.add(b));
    const Stamp t = at_ms(10 * fraction(random));
    const double f = seconds(t) / 0.01;
    const PoseAt pose = track.pose_at(t);
    ASSERT_EQ(pose.status, PoseStatus::ok);
    const Eigen::Matrix3d& turn = pose.tracker_from_probe.rotation;
    EXPECT_TRUE(is_rotation(turn, 1e-9));
    const double whole = turn_between(a.tracker_from_probe.rotation, b.tracker_from_probe.rotation);
    EXPECT_NEAR(turn_between(a.tracker_from_probe.rotation, turn), f * whole, 1e-6);
    EXPECT_NEAR(turn_between(turn, b.tracker_from_probe.rotation), (1 - f) * whole, 1e-6);
    const Eigen::Vector3d straight =
        (1 - f) * a.tracker_from_probe.translation + f * b.tracker_from_probe.translation;
    EXPECT_LT((pose.tracker_from_probe.translation - straight).norm(), 1e-9);
  }
}

TEST(PoseTrack, NeverExtrapolates) {
  PoseTrack track(8);
  EXPECT_EQ(track.pose_at(at_ms(1)).status, PoseStatus::not_yet);
  ASSERT_TRUE(track.add(reading(10, 0)));
  ASSERT_TRUE(track.add(reading(14, 0)));
  EXPECT_EQ(track.pose_at(at_ms(14.02)).status, PoseStatus::not_yet);
  EXPECT_EQ(track.pose_at(at_ms(9.98)).status, PoseStatus::gap);
}

TEST(PoseTrack, TimesWithinTenMicrosecondsAreEqual) {
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(10, 5)));
  for (const int off_us : {-10, 0, 10}) {
    const PoseAt pose = track.pose_at(at_ms(10) + microseconds(off_us));
    EXPECT_EQ(pose.status, PoseStatus::ok) << off_us;
    EXPECT_EQ(pose.tracker_from_probe.translation.x(), 5);
  }
  EXPECT_EQ(track.pose_at(at_ms(10) + microseconds(11)).status, PoseStatus::not_yet);
  EXPECT_EQ(track.pose_at(at_ms(10) - microseconds(11)).status, PoseStatus::gap);
  // Equal to a bad reading is poor even when the neighbours are good.
  ASSERT_TRUE(track.add(reading(14, 0, 0, PoseQuality::distorted)));
  ASSERT_TRUE(track.add(reading(18, 0)));
  EXPECT_EQ(track.pose_at(at_ms(14) + microseconds(5)).status, PoseStatus::poor);
  EXPECT_EQ(track.pose_at(at_ms(18) - microseconds(5)).status, PoseStatus::ok);
}

TEST(PoseTrack, BridgesAGapUpToTheLimitAndNoFurther) {
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(track.add(reading(50, 50)));
  ASSERT_TRUE(track.add(reading(100.1, 0)));
  EXPECT_EQ(track.pose_at(at_ms(25)).status, PoseStatus::ok);
  EXPECT_EQ(track.pose_at(at_ms(75)).status, PoseStatus::gap);
}

TEST(PoseTrack, NeverBridgesARestartOfTheTracker) {
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(track.add(reading(4, 0, 0, PoseQuality::good, 2)));
  EXPECT_EQ(track.pose_at(at_ms(2)).status, PoseStatus::new_epoch);
  // A new epoch whose clock fit starts a little earlier wins over the end of the old one.
  ASSERT_TRUE(track.add(reading(3, 9, 0, PoseQuality::good, 3)));
  EXPECT_EQ(track.newest().epoch, 3U);
  EXPECT_EQ(track.size(), 2U);
}

TEST(PoseTrack, ABadReadingOnEitherSideIsPoor) {
  for (const PoseQuality bad :
       {PoseQuality::distorted, PoseQuality::outside, PoseQuality::fault, PoseQuality::missing}) {
    PoseTrack track(8);
    ASSERT_TRUE(track.add(reading(0, 0)));
    ASSERT_TRUE(track.add(reading(4, 0, 0, bad)));
    ASSERT_TRUE(track.add(reading(8, 0)));
    EXPECT_EQ(track.pose_at(at_ms(2)).status, PoseStatus::poor);
    EXPECT_EQ(track.pose_at(at_ms(6)).status, PoseStatus::poor);
  }
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(track.add(reading(4, 0, 0, PoseQuality::degraded)));
  EXPECT_EQ(track.pose_at(at_ms(2)).status, PoseStatus::ok);
  EXPECT_EQ(track.pose_at(at_ms(2)).quality, PoseQuality::degraded);
}

TEST(PoseTrack, ANonFinitePoseIsAFault) {
  PoseTrack track(8);
  PoseSample bad = reading(4, std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE(track.add(reading(0, 0)));
  ASSERT_TRUE(track.add(bad));
  EXPECT_EQ(track.pose_at(at_ms(2)).status, PoseStatus::poor);
  EXPECT_EQ(track.newest().quality, PoseQuality::fault);
}

TEST(PoseTrack, RefusesAReadingThatIsNotLater) {
  PoseTrack track(8);
  ASSERT_TRUE(track.add(reading(4, 1)));
  EXPECT_FALSE(track.add(reading(4, 2)));
  EXPECT_FALSE(track.add(reading(3, 2)));
  EXPECT_EQ(track.size(), 1U);
  EXPECT_EQ(track.newest().tracker_from_probe.translation.x(), 1);
}

TEST(PoseTrack, ForgetsTheOldestAndTakesNoHeap) {
  PoseTrack track(16);
  const test::AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(track.add(reading(4.0 * i, i)));
    if (i > 0) {
      const PoseAt pose = track.pose_at(at_ms(4.0 * i - 1));
      ASSERT_EQ(pose.status, PoseStatus::ok);
      ASSERT_NEAR(pose.tracker_from_probe.translation.x(), i - 0.25, 1e-9);
    }
  }
  EXPECT_EQ(allocations.count(), 0U);
  EXPECT_EQ(track.size(), 16U);
  EXPECT_EQ(track.pose_at(at_ms(4.0 * 83 + 1)).status, PoseStatus::gap);
  EXPECT_EQ(track.pose_at(at_ms(4.0 * 84 + 1)).status, PoseStatus::ok);
}

}  // namespace
}  // namespace sonoband
