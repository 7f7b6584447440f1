#include "core/sweep/frame_ring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "tests/core/sweep/ring_support.h"
#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

using std::chrono::milliseconds;
using test::at_ms;
using test::intact;
using test::small_ring;

// Frame n is captured at 10 n ms; every third has no pose.
Published put(FrameRing& ring, std::uint64_t n) {
  RingSlot* slot = ring.claim();
  if (slot == nullptr) {
    ADD_FAILURE() << "no slot for frame " << n;
    return Published::ring_full;
  }
  test::fill(*slot, n, at_ms(10.0 * static_cast<double>(n)));
  if (n % 3 != 0) test::pose(*slot, static_cast<double>(n));
  return ring.publish(*slot);
}

std::vector<std::uint64_t> numbers(std::span<const SweepFrame> frames) {
  std::vector<std::uint64_t> out;
  for (const SweepFrame& f : frames) {
    EXPECT_TRUE(intact(f)) << "frame " << f.raw.device_sequence;
    out.push_back(f.raw.device_sequence);
  }
  return out;
}

using Numbers = std::vector<std::uint64_t>;

TEST(FrameRing, TakesItsMemoryInOnePieceAndNothingAfter) {
  const test::AllocationCounter all;
  FrameRing ring(small_ring(12));
  EXPECT_EQ(all.count(), 1U);
  const test::AllocationCounter after;
  for (std::uint64_t n = 1; n < 10; ++n) put(ring, n);
  Sweep sweep = ring.begin_sweep(1, at_ms(95), milliseconds(20));
  for (std::uint64_t n = 10; n < 40; ++n) put(ring, n);
  const FrameLease lease = ring.latest();
  const Sweep copy = sweep;
  ring.end_sweep(at_ms(300), {});
  EXPECT_FALSE(copy.view().frames.empty());
  sweep = {};
  EXPECT_EQ(after.count(), 0U);
  EXPECT_GE(ring.memory().size(), 12U * 64 * 4);
}

TEST(FrameRing, RowsAreAlignedAndSlotsDoNotTouch) {
  FrameRing ring(small_ring(6));
  std::vector<RingSlot*> slots;
  for (int i = 0; i < 6; ++i) {
    slots.push_back(ring.claim());
    ASSERT_NE(slots.back(), nullptr);
    for (int y = 0; y < 4; ++y)
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(slots.back()->pixels.row(y)) % 64, 0U);
    test::fill(*slots.back(), static_cast<std::uint64_t>(i), at_ms(i));
  }
  EXPECT_EQ(ring.claim(), nullptr) << "all are claimed";
  for (RingSlot* s : slots) EXPECT_TRUE(intact(s->frame));
  ring.discard(*slots[2]);
  EXPECT_EQ(ring.claim(), slots[2]);
}

TEST(FrameRing, IdleItOverwritesTheOldestAndShowsTheNewest) {
  FrameRing ring(small_ring(6));
  EXPECT_FALSE(ring.latest());
  for (std::uint64_t n = 1; n < 50; ++n) {
    EXPECT_EQ(put(ring, n), Published::live);
    const FrameLease newest = ring.latest();
    ASSERT_TRUE(newest);
    EXPECT_EQ(newest.frame().raw.device_sequence, n);
    EXPECT_TRUE(intact(newest.frame()));
  }
  // Six slots hold the last six frames: that is how far back a pre-roll can go with half of the room.
  RingSlot* oldest = ring.claim();
  EXPECT_EQ(oldest->frame.raw.device_sequence, 0U) << "a claimed slot starts clean";
  ring.discard(*oldest);
  EXPECT_EQ(ring.status().published, 49U);
}

TEST(FrameRing, AnUnpublishedFrameIsSeenByNobody) {
  FrameRing ring(small_ring(6));
  put(ring, 1);
  RingSlot* claimed = ring.claim();
  test::fill(*claimed, 2, at_ms(20));
  EXPECT_EQ(ring.latest().frame().raw.device_sequence, 1U);
  const Sweep sweep = ring.begin_sweep(1, at_ms(0), {});
  EXPECT_EQ(numbers(sweep.swept()), Numbers({1}));
  ring.publish(*claimed);
  EXPECT_EQ(numbers(sweep.swept()), Numbers({1, 2}));
  ring.end_sweep(at_ms(100), {});
}

TEST(FrameRing, SweepReachesBackToThePressAndItsPreRollAndForwardToTheRelease) {
  FrameRing ring(small_ring(40));
  for (std::uint64_t n = 1; n <= 12; ++n) put(ring, n);
  // The press of 95 ms becomes known at 120 ms.
  const Sweep sweep = ring.begin_sweep(5, at_ms(95), milliseconds(30));
  ASSERT_TRUE(sweep);
  EXPECT_TRUE(sweep.start_complete());
  EXPECT_FALSE(sweep.released());
  EXPECT_EQ(sweep.ledger(), nullptr);
  EXPECT_EQ(numbers(sweep.pre_roll()), Numbers({7, 8, 9}));
  EXPECT_EQ(numbers(sweep.swept()), Numbers({10, 11, 12}));
  for (std::uint64_t n = 13; n <= 18; ++n) EXPECT_EQ(put(ring, n), Published::in_sweep);
  EXPECT_EQ(numbers(sweep.swept()), Numbers({10, 11, 12, 13, 14, 15, 16, 17, 18}));
  // The release of 160 ms becomes known at 180 ms; 160 itself counts.
  LossLedger ledger;
  ledger.received = 7;
  ring.end_sweep(at_ms(160), ledger);
  EXPECT_EQ(put(ring, 19), Published::live);
  EXPECT_EQ(numbers(sweep.pre_roll()), Numbers({7, 8, 9}));
  EXPECT_EQ(numbers(sweep.swept()), Numbers({10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(sweep.released(), at_ms(160));
  ASSERT_NE(sweep.ledger(), nullptr);
  EXPECT_EQ(*sweep.ledger(), ledger);
}

TEST(FrameRing, ViewHasTheSweptFramesWithAPose) {
  FrameRing ring(small_ring(40));
  for (std::uint64_t n = 1; n <= 12; ++n) put(ring, n);
  const Sweep sweep = ring.begin_sweep(5, at_ms(70), milliseconds(20));
  for (std::uint64_t n = 13; n <= 16; ++n) put(ring, n);
  Numbers seen;
  for (const TrackedFrame* f : sweep.view().frames) {
    EXPECT_EQ(f->pose_status, PoseStatus::ok);
    EXPECT_EQ(f->sweep_id, 5);
    seen.push_back(static_cast<std::uint64_t>(f->world_from_image.translation.z()));
  }
  EXPECT_EQ(seen, Numbers({7, 8, 10, 11, 13, 14, 16}));
  // Sequence counts all frames held, so neighbours are told from frames that lost their pose between them.
  EXPECT_EQ(sweep.view().frames[0]->sequence, 2);
  EXPECT_EQ(sweep.view().frames[2]->sequence, 5);
  ring.end_sweep(at_ms(145), {});
  EXPECT_EQ(sweep.view().frames.size(), 6U) << "16 was taken after the release";
}

TEST(FrameRing, ViewOfNothingIsEmptyAndHasTheMask) {
  Pixels mask(20, 4);
  mask.view()(3, 1) = 255;
  FrameRing ring(small_ring(8), mask.view());
  const Sweep sweep = ring.begin_sweep(1, at_ms(0), milliseconds(50));
  EXPECT_TRUE(sweep.view().frames.empty());
  ASSERT_EQ(sweep.view().mask.width, 20);
  EXPECT_EQ(sweep.view().mask(3, 1), 255);
  EXPECT_EQ(sweep.view().mask(4, 1), 0);
  put(ring, 3);  // no pose
  EXPECT_TRUE(sweep.view().frames.empty());
  EXPECT_EQ(sweep.swept().size(), 1U);
  ring.end_sweep(at_ms(50), {});
}

TEST(FrameRing, HeldSlotsAreNeverOverwrittenAndFullRefuses) {
  FrameRing ring(small_ring(10, 3));
  Sweep first = ring.begin_sweep(1, at_ms(0), {});
  for (std::uint64_t n = 1; n <= 4; ++n) EXPECT_EQ(put(ring, n), Published::in_sweep);
  ring.end_sweep(at_ms(45), {});
  EXPECT_EQ(ring.status().room, 3U);
  const Sweep second = ring.begin_sweep(2, at_ms(45), {});
  for (std::uint64_t n = 5; n <= 7; ++n) EXPECT_EQ(put(ring, n), Published::in_sweep);
  for (std::uint64_t n = 8; n <= 60; ++n) {
    EXPECT_EQ(put(ring, n), Published::ring_full);
    EXPECT_EQ(ring.latest().frame().raw.device_sequence, n) << "the live view goes on";
  }
  EXPECT_EQ(numbers(first.swept()), Numbers({1, 2, 3, 4}));
  EXPECT_EQ(numbers(second.swept()), Numbers({5, 6, 7}));
  // Room that comes back does not tear a hole into the full sweep.
  first = {};
  EXPECT_EQ(ring.status().held, 3U);
  EXPECT_EQ(put(ring, 61), Published::ring_full);
  EXPECT_EQ(numbers(second.swept()), Numbers({5, 6, 7}));
  ring.end_sweep(at_ms(75), {});
  EXPECT_EQ(ring.status().room, 4U);
  EXPECT_TRUE(ring.begin_sweep(3, at_ms(700), {}));
  ring.end_sweep(at_ms(701), {});
}

TEST(FrameRing, APressIsRefusedWithoutRoomOrWithoutARecord) {
  FrameRing ring(small_ring(20, 3, 2));
  const Sweep a = ring.begin_sweep(1, at_ms(0), {});
  put(ring, 1);
  ring.end_sweep(at_ms(15), {});
  Sweep b = ring.begin_sweep(2, at_ms(15), {});
  put(ring, 2);
  ring.end_sweep(at_ms(25), {});
  EXPECT_FALSE(ring.begin_sweep(3, at_ms(25), {})) << "two may be held";
  EXPECT_FALSE(ring.growing());
  b = {};
  b = ring.begin_sweep(3, at_ms(25), {});
  EXPECT_TRUE(b);
  for (std::uint64_t n = 3; n < 40; ++n) put(ring, n);
  ring.end_sweep(at_ms(400), {});
  EXPECT_EQ(ring.status().room, 0U);
}

TEST(FrameRing, NoRoomRefusesAPress) {
  FrameRing ring(small_ring(6, 3, 2));
  const Sweep a = ring.begin_sweep(1, at_ms(0), {});
  for (std::uint64_t n = 1; n < 9; ++n) put(ring, n);
  ring.end_sweep(at_ms(400), {});
  EXPECT_FALSE(ring.begin_sweep(2, at_ms(500), {}));
}

TEST(FrameRing, PreRollMaySharePicturesWithTheSweepBefore) {
  FrameRing ring(small_ring(30));
  const Sweep first = ring.begin_sweep(1, at_ms(0), {});
  for (std::uint64_t n = 1; n <= 6; ++n) put(ring, n);
  ring.end_sweep(at_ms(60), {});
  Sweep second = ring.begin_sweep(2, at_ms(65), milliseconds(100));
  put(ring, 7);
  EXPECT_EQ(numbers(second.pre_roll()), Numbers({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(second.pre_roll()[0].tracked.sweep_id, 2);
  EXPECT_EQ(first.swept()[0].tracked.sweep_id, 1);
  EXPECT_EQ(ring.status().held, 7U) << "shared slots count once";
  ring.end_sweep(at_ms(75), {});
  second = {};
  EXPECT_EQ(ring.status().held, 6U);
  for (std::uint64_t n = 8; n < 60; ++n) put(ring, n);
  EXPECT_EQ(numbers(first.swept()), Numbers({1, 2, 3, 4, 5, 6}));
}

TEST(FrameRing, PreRollLeavesHalfOfTheRoomToTheSweep) {
  FrameRing ring(small_ring(13, 3));
  for (std::uint64_t n = 1; n <= 30; ++n) put(ring, n);
  const Sweep sweep = ring.begin_sweep(1, at_ms(295), milliseconds(1000));
  EXPECT_EQ(numbers(sweep.swept()), Numbers({30}));
  EXPECT_EQ(numbers(sweep.pre_roll()), Numbers({26, 27, 28, 29}));
  ring.end_sweep(at_ms(300), {});
}

TEST(FrameRing, APressFromBeforeTheRingsMemorySaysSo) {
  FrameRing ring(small_ring(8));
  for (std::uint64_t n = 1; n <= 30; ++n) put(ring, n);
  const Sweep sweep = ring.begin_sweep(1, at_ms(100), {});
  EXPECT_FALSE(sweep.start_complete());
  EXPECT_EQ(numbers(sweep.swept()), Numbers({23, 24, 25, 26, 27})) << "from the oldest kept, up to the room";
  ring.end_sweep(at_ms(300), {});
}

TEST(FrameRing, ASlotBeingFilledIsInNoSweep) {
  FrameRing ring(small_ring(8));
  for (std::uint64_t n = 1; n <= 30; ++n) put(ring, n);
  RingSlot* claimed = ring.claim();  // was frame 23
  test::fill(*claimed, 31, at_ms(310));
  const Sweep sweep = ring.begin_sweep(1, at_ms(100), {});
  EXPECT_EQ(numbers(sweep.swept()), Numbers({24, 25, 26, 27, 28}));
  ring.discard(*claimed);
  ring.end_sweep(at_ms(300), {});
}

TEST(FrameRing, LastHoldFreesWhicheverItIs) {
  FrameRing ring(small_ring(12));
  Sweep mine = ring.begin_sweep(1, at_ms(0), {});
  put(ring, 1);
  mine = {};  // dropped while it grows: the ring goes on with it until the release
  EXPECT_EQ(put(ring, 2), Published::in_sweep);
  EXPECT_EQ(ring.status().held, 2U);
  ring.end_sweep(at_ms(25), {});
  EXPECT_EQ(ring.status().held, 0U);
  EXPECT_EQ(ring.status().sweeps, 0U);

  Sweep a = ring.begin_sweep(2, at_ms(25), {});
  put(ring, 3);
  ring.end_sweep(at_ms(35), {});
  Sweep b = a;
  Sweep c = std::move(a);
  EXPECT_FALSE(a);  // NOLINT(bugprone-use-after-move): the moved-from state is what is tested
  c = {};
  EXPECT_EQ(ring.status().held, 1U);
  EXPECT_EQ(numbers(b.swept()), Numbers({3}));
  b = std::move(c);
  EXPECT_EQ(ring.status().held, 0U);
}

TEST(FrameRing, LeaseKeepsItsFrameAndFewAreLent) {
  FrameRing ring(small_ring(6));
  put(ring, 1);
  FrameLease kept = ring.latest();
  for (std::uint64_t n = 2; n < 40; ++n) put(ring, n);
  EXPECT_EQ(kept.frame().raw.device_sequence, 1U);
  EXPECT_TRUE(intact(kept.frame()));
  const FrameLease newer = ring.latest();
  EXPECT_EQ(newer.frame().raw.device_sequence, 39U);
  EXPECT_FALSE(ring.latest()) << "two leases are set";
  EXPECT_EQ(ring.status().leases_refused, 1U);
  kept = FrameLease();
  EXPECT_TRUE(ring.latest());
}

TEST(FrameRing, TheNewestFrameIsNotOverwrittenEvenWhenItIsTheOnlyFreeOne) {
  FrameRing ring(small_ring(6, 3, 3));
  const Sweep sweep = ring.begin_sweep(1, at_ms(0), {});
  for (std::uint64_t n = 1; n <= 6; ++n) put(ring, n);
  RingSlot* a = ring.claim();
  RingSlot* b = ring.claim();
  ASSERT_TRUE(a != nullptr && b != nullptr);
  EXPECT_EQ(ring.claim(), nullptr);
  EXPECT_EQ(ring.latest().frame().raw.device_sequence, 6U);
  ring.discard(*a);
  ring.discard(*b);
  ring.end_sweep(at_ms(60), {});
}

}  // namespace
}  // namespace sonoband
