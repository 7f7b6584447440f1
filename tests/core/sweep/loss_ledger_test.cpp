#include "core/sweep/loss_ledger.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

namespace sonoband {
namespace {

FrameOutcome random_outcome(std::mt19937_64& random) {
  FrameOutcome o;
  o.kind = static_cast<FrameOutcome::Kind>(random() % 4);
  o.pose = static_cast<PoseStatus>(random() % pose_status_count);
  o.cause = static_cast<LossCause>(random() % loss_cause_count);
  o.count = o.kind == FrameOutcome::Kind::device_gap ? 1 + random() % 9 : 1;
  return o;
}

TEST(LossLedger, EveryReceivedFrameIsStoredOrLostForACause) {
  std::mt19937_64 random(3);
  LossLedger ledger;
  std::uint64_t received = 0;
  std::uint64_t stored = 0;
  for (int i = 0; i < 1000; ++i) {
    const FrameOutcome o = random_outcome(random);
    book(ledger, o);
    received += o.kind == FrameOutcome::Kind::stored || o.kind == FrameOutcome::Kind::lost ? 1 : 0;
    stored += o.kind == FrameOutcome::Kind::stored ? 1 : 0;
    ASSERT_TRUE(ledger.balanced());
  }
  EXPECT_EQ(ledger.received, received);
  EXPECT_EQ(ledger.stored, stored);
  EXPECT_EQ(ledger.all_lost(), received - stored);
  ++ledger.received;
  EXPECT_FALSE(ledger.balanced());
}

TEST(LossLedger, UnbookingIsTheOppositeOfBooking) {
  std::mt19937_64 random(4);
  LossLedger ledger;
  std::vector<FrameOutcome> outcomes;
  for (int i = 0; i < 200; ++i) outcomes.push_back(random_outcome(random));
  for (const FrameOutcome& o : outcomes) book(ledger, o);
  EXPECT_NE(ledger, LossLedger());
  for (const FrameOutcome& o : outcomes) unbook(ledger, o);
  EXPECT_EQ(ledger, LossLedger());
}

TEST(LossLedger, EachCounterHasItsOwnLine) {
  LossLedger ledger;
  ledger.lost[static_cast<std::size_t>(LossCause::late)] = 7;
  ledger.by_pose[static_cast<std::size_t>(PoseStatus::poor)] = 8;
  ledger.pedal_overrun = 9;
  std::set<std::string> names;
  for (const LedgerLine& l : lines(ledger)) {
    names.insert(l.name);
    const std::string name = l.name;
    EXPECT_EQ(l.value, name == "lost_late"       ? 7U
                       : name == "pose_poor"     ? 8U
                       : name == "pedal_overrun" ? 9U
                                                 : 0U);
  }
  EXPECT_EQ(names.size(), ledger_line_count);
  EXPECT_STREQ(name_of(LossCause::ring_full), "ring_full");
  EXPECT_STREQ(name_of(PoseStatus::new_epoch), "new_epoch");
}

}  // namespace
}  // namespace sonoband
