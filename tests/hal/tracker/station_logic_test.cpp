// Order of records, plausible motion, and the ladder of recovery: pure values in, values out.
#include <gtest/gtest.h>

#include "hal/tracker/frame_counter.h"
#include "hal/tracker/pose_continuity.h"
#include "hal/tracker/recovery_ladder.h"
#include "hal/tracker/station_stream.h"

namespace sonoband {
namespace {

using Order = FrameCounter::Step;

// Milliseconds of a frame at 240 Hz.
std::uint32_t ms(std::uint32_t frame) {
  return static_cast<std::uint32_t>((frame * std::uint64_t{1000} + 120) / 240);
}

TEST(FrameCounter, InOrderLostAndDuplicate) {
  FrameCounter c;
  EXPECT_EQ(c.judge(100, ms(100), false).step, Order::in_order);
  EXPECT_EQ(c.judge(101, ms(101), false).step, Order::in_order);
  EXPECT_EQ(c.judge(101, ms(101), true).step, Order::duplicate);
  const auto after_gap = c.judge(105, ms(105), false);
  EXPECT_EQ(after_gap.step, Order::in_order);
  EXPECT_EQ(after_gap.lost, 3u);
  EXPECT_EQ(c.judge(1105, ms(1105), false).lost, 999u);
}

TEST(FrameCounter, TheWrapIsOneStep) {
  FrameCounter c;
  c.judge(0xfffffffeU, 0xfffffff9U, false);
  EXPECT_EQ(c.judge(0xffffffffU, 0xfffffffdU, false).step, Order::in_order);
  EXPECT_EQ(c.judge(0, 1, false).step, Order::in_order);
  const auto v = c.judge(2, 10, false);
  EXPECT_EQ(v.step, Order::in_order);
  EXPECT_EQ(v.lost, 1u);
}

TEST(FrameCounter, ARestartIsBelievedWhenConfirmed) {
  FrameCounter c;
  c.judge(5000, ms(5000), false);
  EXPECT_EQ(c.judge(1, ms(1), false).step, Order::doubtful);
  EXPECT_EQ(c.judge(2, ms(2), false).step, Order::new_epoch);
  EXPECT_EQ(c.judge(3, ms(3), false).step, Order::in_order);
}

TEST(FrameCounter, OneOddRecordChangesNothing) {
  FrameCounter c;
  c.judge(5000, ms(5000), false);
  EXPECT_EQ(c.judge(9999, ms(5001), false).step, Order::doubtful);
  const auto v = c.judge(5002, ms(5002), false);
  EXPECT_EQ(v.step, Order::in_order);
  EXPECT_EQ(v.lost, 1u);
}

TEST(FrameCounter, TooLongAGapIsARestart) {
  FrameCounter c;
  c.judge(10, ms(10), false);
  EXPECT_EQ(c.judge(1011, ms(1011), false).step, Order::doubtful);
  EXPECT_EQ(c.judge(1012, ms(1012), false).step, Order::new_epoch);
}

TEST(FrameCounter, TheClockMustAgree) {
  FrameCounter c;
  c.judge(10, ms(10), false);
  EXPECT_EQ(c.judge(11, ms(11) + 2, false).step, Order::in_order);
  EXPECT_EQ(c.judge(12, ms(12) + 9, false).step, Order::doubtful);
}

TEST(FrameCounter, AnotherPoseOfTheSameCountIsNoDuplicate) {
  FrameCounter c;
  c.judge(10, ms(10), false);
  EXPECT_EQ(c.judge(10, ms(10), false).step, Order::new_epoch);
}

using Motion = PoseContinuity::Step;

class Continuity : public ::testing::Test {
 protected:
  Motion see(const Eigen::Vector3d& p, Duration elapsed = from_seconds(1.0 / 240)) {
    return continuity_.judge(p, q_, elapsed);
  }
  PoseContinuity continuity_;
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
};

TEST_F(Continuity, MotionOfAHandFollows) {
  double x = 200;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(see({x += 8, 0, 0}), Motion::follows);  // 1.9 m/s
}

TEST_F(Continuity, OneJumpIsRefusedAndThreeThatAgreeAreANewPlace) {
  see({200, 0, 0});
  EXPECT_EQ(see({200, 90, 0}), Motion::jumped);
  EXPECT_EQ(see({201, 0, 0}), Motion::follows);
  EXPECT_EQ(see({200, 90, 0}), Motion::jumped);
  EXPECT_EQ(see({200, 91, 0}), Motion::jumped);
  EXPECT_EQ(see({200, 92, 0}), Motion::new_place);
  EXPECT_EQ(see({200, 93, 0}), Motion::follows);
}

TEST_F(Continuity, JumpsThatDisagreeAreNeverAPlace) {
  see({200, 0, 0});
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see({200, i % 2 == 0 ? 100.0 : -100.0, 0}), Motion::jumped);
}

TEST_F(Continuity, AcrossTheHemispherePlaneAndBack) {
  see({200, 50, 10});
  for (int i = 0; i < 50; ++i) EXPECT_EQ(see({-200, -50.0 - i, -10}), Motion::mirrored);
  EXPECT_EQ(see({-200, -100, -10}, from_seconds(2)), Motion::mirrored);
  EXPECT_EQ(see({200, 101, 10}), Motion::follows);
}

TEST_F(Continuity, NearTheSourceNothingIsMirrored) {
  see({4, 0, 0});
  EXPECT_EQ(see({-4, 0, 0}), Motion::follows);
}

TEST_F(Continuity, ATurnNoHandMakesIsRefused) {
  see({200, 0, 0});
  q_ = Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX()));
  EXPECT_EQ(see({200, 0, 0}), Motion::jumped);
}

TEST_F(Continuity, TheOtherSignIsTheSameRotation) {
  see({200, 0, 0});
  q_ = Eigen::Quaterniond(-1, 0, 0, 0);
  EXPECT_EQ(see({200, 0, 0}), Motion::follows);
  EXPECT_EQ(q_.w(), 1);
}

TEST_F(Continuity, AfterALongGapAnywhereIsConfirmedWithoutANewEpoch) {
  see({200, 0, 0});
  EXPECT_EQ(see({200, 300, 0}, from_seconds(1)), Motion::jumped);
  EXPECT_EQ(see({200, 301, 0}), Motion::jumped);
  EXPECT_EQ(see({200, 302, 0}), Motion::follows);
}

Stamp at(double s) {
  return Stamp(std::chrono::seconds(1000)) + from_seconds(s);
}

// Found by the fuzzer: half a period after a reading that came this instant lies in the future.
TEST(StationStream, AMarkOfSilenceIsAfterTheLastReadingAndNeverAheadOfTheClock) {
  const Duration period = from_seconds(1.0 / 240);
  const Stamp start{std::chrono::seconds(1000)};
  std::uint32_t next_epoch = 1;
  StationStream stream;
  stream.begin(1, LinkConfig{}, period, next_epoch, start);
  LinkCounters counters;
  LinkReason reason = LinkReason::none;
  std::optional<Reading> last;
  Stamp now = start;
  for (std::uint32_t frame = 1; frame <= 60; ++frame) {
    now = start + frame * period;
    StationRecord record;
    record.position_mm = Eigen::Vector3d(100 + 0.1 * frame, 0, 0);
    record.quaternion_wxyz = Eigen::Vector4d(1, 0, 0, 0);
    record.frame = frame;
    record.time_ms = ms(frame);
    last = stream.take(record, now, counters, reason);
  }
  ASSERT_TRUE(last);
  const std::optional<Reading> mark = stream.mark_missing(now + Duration(10));
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->pose.quality, PoseQuality::missing);
  EXPECT_GT(mark->pose.time, last->pose.time);
  EXPECT_LE(mark->pose.time, now + Duration(10));
  EXPECT_FALSE(stream.mark_missing(now + Duration(20)));
}

TEST(RecoveryLadder, ClimbsWhileTroubleComesBackAndForgetsAfterTenGoodSeconds) {
  RecoveryLadder l;
  l.came(at(0));
  EXPECT_EQ(l.next(LinkReason::silent, at(100), false), Rung::restart);
  EXPECT_EQ(l.next(LinkReason::no_records, at(100.3), false), Rung::reconfigure);
  EXPECT_EQ(l.next(LinkReason::no_records, at(102), false), Rung::reset_port);
  EXPECT_EQ(l.next(LinkReason::no_records, at(106), false), Rung::reinitialise);
  l.restarted(at(106));
  EXPECT_EQ(l.next(LinkReason::no_answer, at(118), false), Rung::reconfigure);  // still in its self-test
  EXPECT_EQ(l.next(LinkReason::no_answer, at(122), false), Rung::give_up);
  EXPECT_EQ(l.next(LinkReason::no_answer, at(134), false), Rung::give_up);
  EXPECT_EQ(l.next(LinkReason::no_answer, at(167), false), Rung::reinitialise);
  l.restarted(at(167));
  l.healthy(at(172));
  EXPECT_EQ(l.next(LinkReason::silent, at(176), false), Rung::give_up);
  l.healthy(at(186.1));
  EXPECT_EQ(l.next(LinkReason::silent, at(187), false), Rung::restart);
}

// A halt of two seconds went through every rung, up to a restart of the unit that takes ten.
TEST(RecoveryLadder, WhatMayPassIsNotMetByARestartOfTheUnit) {
  for (const LinkReason why : {LinkReason::stalled, LinkReason::io_error, LinkReason::no_records}) {
    RecoveryLadder l;
    l.came(at(0));
    for (double t = 100; t < 104.9; t += 0.1) EXPECT_LE(l.next(why, at(t), false), Rung::reset_port);
    EXPECT_EQ(l.next(why, at(105), false), Rung::reinitialise);
  }
  RecoveryLadder l;
  l.came(at(0));
  EXPECT_EQ(l.next(LinkReason::hardware, at(100), false), Rung::reinitialise) << "the unit asks for it";
}

TEST(RecoveryLadder, TheLastResortIsNotForRecordings) {
  RecoveryLadder l;
  l.came(at(0));
  for (int i = 0; i < 50; ++i) EXPECT_LT(l.next(LinkReason::hardware, at(100 + i), true), Rung::reinitialise);
  EXPECT_EQ(l.next(LinkReason::hardware, at(160), false), Rung::reinitialise);
}

TEST(RecoveryLadder, AUnitThatJustCameIsGivenTime) {
  RecoveryLadder l;
  l.came(at(0));
  for (int i = 0; i < 7; ++i) EXPECT_EQ(l.next(LinkReason::no_answer, at(2.0 * i), false), Rung::reconfigure);
  EXPECT_GT(l.next(LinkReason::no_answer, at(15), false), Rung::reconfigure);
}

TEST(OperatorSentences, EachReasonHasItsOwnWithACure) {
  for (int r = 1; r <= static_cast<int>(LinkReason::mirrored); ++r) {
    const std::string sentence = operator_sentence(static_cast<LinkReason>(r));
    EXPECT_GT(sentence.size(), 20u) << r;
    EXPECT_EQ(sentence.back(), '.') << r;
    for (int other = 0; other < r; ++other)
      EXPECT_NE(sentence, operator_sentence(static_cast<LinkReason>(other)));
  }
  EXPECT_STREQ(operator_sentence(LinkReason::none), "");
}

}  // namespace
}  // namespace sonoband
