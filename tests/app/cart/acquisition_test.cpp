#include "app/cart/acquisition.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/app/cart/cart_support.h"
#include "tests/support/allocation_counter.h"

namespace sonoband::cart {
namespace {

using std::chrono::milliseconds;
using test::at_ms;
using test::Picture;
using test::reading;

// Frames at 25 Hz, poses before and after each, so every frame is published at once.
class Rig {
 public:
  explicit Rig(const AcquisitionSettings& settings = test::small_cart().acquisition,
               std::uint32_t slots = 100)
      : ring(test::small_ring(slots)), acquisition(ring, settings) {}

  Stamp time_of(std::uint64_t n) const { return at_ms(40.0 * static_cast<double>(n)); }
  void poses(std::uint64_t n) {
    acquisition.on_pose(reading(time_of(n) - milliseconds(2)), time_of(n));
    acquisition.on_pose(reading(time_of(n) + milliseconds(2)), time_of(n) + milliseconds(2));
  }
  // As picture `shown` with the number and time of frame n.
  Frame frame(std::uint64_t n, const Picture& picture) const {
    return picture.frame(n, time_of(n), time_of(n) + milliseconds(1));
  }
  void put(std::uint64_t n) { put(n, n); }
  void put(std::uint64_t n, std::uint64_t shown) {
    const Picture picture(shown);
    acquisition.on_frame(frame(n, picture), time_of(n) + milliseconds(1));
    poses(n);
  }
  std::uint64_t lost(LossCause c) const { return acquisition.ledger().lost_for(c); }
  std::vector<Notice::Kind> notices() {
    std::vector<Notice::Kind> kinds;
    while (auto n = acquisition.take_notice()) {
      kinds.push_back(n->kind);
      if (n->kind == Notice::Kind::started) sweep = n->sweep;
    }
    return kinds;
  }

  FrameRing ring;
  Acquisition acquisition;
  Sweep sweep;
};

using Kinds = std::vector<Notice::Kind>;

TEST(Acquisition, AFrameIsWhereCalibrationAndTrackerPutIt) {
  AcquisitionSettings settings = test::small_cart().acquisition;
  settings.probe_from_image.linear = Eigen::Vector3d(0.2, 0.3, 1).asDiagonal();
  settings.probe_from_image.translation = {5, 6, 7};
  settings.world_from_tracker.translation = {100, 0, 0};
  settings.pairing.latency_offset = milliseconds(10);
  Rig rig(settings);
  for (int ms = 0; ms <= 60; ms += 4) {
    PoseSample s = reading(at_ms(ms));
    s.tracker_from_probe.rotation =
        Eigen::AngleAxisd(std::acos(-1.0) / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    s.tracker_from_probe.translation = {0, 0, 1.0 * ms};
    rig.acquisition.on_pose(s, at_ms(ms));
  }
  const Picture picture(1);
  rig.acquisition.on_frame(rig.frame(1, picture), at_ms(60));
  const FrameLease lease = rig.ring.latest();
  ASSERT_TRUE(lease);
  const TrackedFrame& f = lease.frame().tracked;
  ASSERT_EQ(f.pose_status, PoseStatus::ok);
  // Stamped 40 ms, 10 ms offset: z = 30. Pixel (10, 20) is (7, 12, 7) on the probe; turned (-12, 7, 7).
  EXPECT_EQ(f.captured, at_ms(30));
  EXPECT_EQ(lease.frame().raw.stamped, at_ms(40));
  const Eigen::Vector3d p = (f.world_from_image * Point<frame::Image>{{10, 20, 0}}).v;
  EXPECT_LT((p - Eigen::Vector3d(88, 7, 37)).norm(), 1e-6) << p.transpose();
  EXPECT_EQ(f.bscan.pixels(3, 2), picture.bytes[(5 + 2) * test::source_width + 4 + 3]);
}

TEST(Acquisition, FramesWithoutAPoseAreKeptMarkedAndCounted) {
  Rig rig;
  rig.acquisition.begin_sweep(at_ms(0));
  const Picture first(1);
  rig.acquisition.on_frame(rig.frame(1, first), at_ms(41));
  rig.acquisition.tick(at_ms(140));
  EXPECT_FALSE(rig.ring.latest()) << "waits for its pose";
  rig.acquisition.tick(at_ms(141));
  ASSERT_TRUE(rig.ring.latest());
  EXPECT_EQ(rig.ring.latest().frame().tracked.pose_status, PoseStatus::not_yet);
  rig.acquisition.on_pose(reading(at_ms(150)), at_ms(150));
  const Picture second(5);
  rig.acquisition.on_frame(rig.frame(5, second), at_ms(201));
  rig.acquisition.on_pose(reading(at_ms(260)), at_ms(260));
  PoseSample bad = reading(at_ms(262));
  bad.quality = PoseQuality::distorted;
  rig.acquisition.on_pose(bad, at_ms(262));
  const Picture third(7);
  rig.acquisition.on_frame(rig.frame(7, third), at_ms(281));
  PoseSample restarted = reading(at_ms(283));
  rig.acquisition.on_pose(restarted, at_ms(283));
  const Picture fourth(8);
  rig.acquisition.on_frame(rig.frame(8, fourth), at_ms(321));
  restarted = reading(at_ms(325));
  restarted.epoch = 1;
  rig.acquisition.on_pose(restarted, at_ms(325));
  const LossLedger& ledger = rig.acquisition.ledger();
  EXPECT_EQ(ledger.stored, 4U);
  for (const PoseStatus s : {PoseStatus::not_yet, PoseStatus::gap, PoseStatus::poor, PoseStatus::new_epoch})
    EXPECT_EQ(ledger.with(s), 1U) << name_of(s);
  rig.notices();
  EXPECT_EQ(rig.sweep.swept().size(), 4U);
  EXPECT_TRUE(rig.sweep.view().frames.empty());
  rig.acquisition.stop(at_ms(400));
}

TEST(Acquisition, ARepeatedPictureIsADuplicateAndAFaintlyNoisyOneToo) {
  Rig rig;
  for (std::uint64_t n = 1; n <= 3; ++n) rig.put(n);
  for (std::uint64_t n = 4; n <= 9; ++n) rig.put(n, 3);
  rig.put(10);
  EXPECT_EQ(rig.lost(LossCause::duplicate), 6U);
  EXPECT_EQ(rig.acquisition.ledger().stored, 4U);
  Picture noisy(10);
  for (std::size_t i = 0; i < noisy.bytes.size(); i += 3)
    noisy.bytes[i] ^= 1;  // a third of a level on average
  rig.acquisition.on_frame(rig.frame(11, noisy), at_ms(441));
  EXPECT_EQ(rig.lost(LossCause::duplicate), 7U);
  for (std::size_t i = 1; i < noisy.bytes.size(); i += 3) noisy.bytes[i] ^= 1;  // two thirds
  rig.acquisition.on_frame(rig.frame(12, noisy), at_ms(481));
  EXPECT_EQ(rig.lost(LossCause::duplicate), 7U);
  const AcquisitionStatus status = rig.acquisition.status(at_ms(481));
  EXPECT_EQ(status.last_frame, at_ms(481));
  rig.acquisition.stop(at_ms(500));
}

TEST(Acquisition, DuplicatesCanBeKept) {
  AcquisitionSettings settings = test::small_cart().acquisition;
  settings.duplicate_levels = 0;
  Rig rig(settings);
  for (std::uint64_t n = 1; n <= 5; ++n) rig.put(n, 1);
  EXPECT_EQ(rig.acquisition.ledger().stored, 5U);
}

TEST(Acquisition, EachRefusalHasItsCause) {
  Rig rig;
  rig.put(1);
  const Picture picture(2);
  Frame f = rig.frame(2, picture);
  f.width = 640;
  rig.acquisition.on_frame(f, at_ms(81));
  EXPECT_EQ(rig.lost(LossCause::bad_size), 1U);
  f = rig.frame(3, picture);
  f.format = PixelFormat::mjpeg;
  rig.acquisition.on_frame(f, at_ms(121));
  EXPECT_EQ(rig.lost(LossCause::bad_format), 1U);
  f = rig.frame(4, picture);
  f.captured = rig.time_of(1);
  rig.acquisition.on_frame(f, at_ms(161));
  f = rig.frame(5, picture);
  f.captured = at_ms(5000);
  rig.acquisition.on_frame(f, at_ms(201));
  EXPECT_EQ(rig.lost(LossCause::bad_stamp), 2U);
  rig.put(6);
  EXPECT_EQ(rig.acquisition.ledger().stored, 2U) << "a wrong stamp does not stop what follows";
  EXPECT_EQ(rig.acquisition.ledger().received, 6U);
  EXPECT_TRUE(rig.acquisition.ledger().balanced());
}

TEST(Acquisition, JumpsOfTheSourcesNumbersAreCounted) {
  Rig rig;
  rig.put(7);
  rig.put(8);
  EXPECT_EQ(rig.acquisition.ledger().device_gap, 0U);
  rig.put(12);
  EXPECT_EQ(rig.acquisition.ledger().device_gap, 3U);
  const Picture picture(13);
  Frame restarted = rig.frame(13, picture);
  restarted.sequence = 0;
  rig.acquisition.on_frame(restarted, at_ms(521));
  EXPECT_EQ(rig.acquisition.ledger().device_gap, 3U);
  EXPECT_EQ(rig.acquisition.ledger().source_resets, 1U);
  Frame wild = rig.frame(14, Picture(14));
  const Picture later(14);
  wild.data = later.bytes.data();
  wild.sequence = ~std::uint64_t{0};
  rig.acquisition.on_frame(wild, at_ms(561));
  EXPECT_EQ(rig.acquisition.ledger().device_gap, 3U);
  EXPECT_EQ(rig.acquisition.ledger().source_resets, 2U);
  rig.acquisition.stop(at_ms(600));
}

TEST(Acquisition, WrongReadingsOfTheTrackerAreRefusedAndCounted) {
  Rig rig;
  rig.acquisition.on_pose(reading(at_ms(10)), at_ms(10));
  rig.acquisition.on_pose(reading(at_ms(9)), at_ms(11));
  rig.acquisition.on_pose(reading(at_ms(900)), at_ms(12));
  EXPECT_EQ(rig.acquisition.ledger().poses, 3U);
  EXPECT_EQ(rig.acquisition.ledger().poses_refused, 2U);
  EXPECT_EQ(rig.acquisition.status(at_ms(12)).last_pose, at_ms(10));
}

TEST(Acquisition, ASweepWithoutLaterFramesEndsWhenTheWaitForThemIsOver) {
  AcquisitionSettings settings = test::small_cart().acquisition;
  settings.pairing.latency_offset = milliseconds(70);
  Rig rig(settings);
  for (std::uint64_t n = 1; n <= 10; ++n) rig.put(n);
  rig.acquisition.begin_sweep(at_ms(200));
  rig.acquisition.end_sweep(at_ms(390));  // the last frame shows 330 ms
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started}));
  rig.acquisition.tick(at_ms(960));
  EXPECT_FALSE(rig.sweep.released());
  rig.acquisition.tick(at_ms(961));
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::ended}));
  EXPECT_EQ(rig.sweep.released(), at_ms(390));
  // A frame taken within the sweep that comes now is late; one taken after it is not.
  const Picture late(11);
  Frame f = rig.frame(11, late);
  f.captured = at_ms(460);
  rig.acquisition.on_frame(f, at_ms(970));
  EXPECT_EQ(rig.lost(LossCause::late), 1U);
  f.sequence = 12;
  f.captured = at_ms(461);
  rig.acquisition.on_frame(f, at_ms(971));
  EXPECT_EQ(rig.lost(LossCause::late), 1U);
  rig.acquisition.stop(at_ms(1000));
}

TEST(Acquisition, ASweepEndsWithTheFirstFrameTakenAfterItsRelease) {
  Rig rig;
  rig.acquisition.begin_sweep(at_ms(100));
  for (std::uint64_t n = 1; n <= 5; ++n) rig.put(n);
  rig.acquisition.end_sweep(at_ms(240));
  rig.put(6);  // at the release: belongs to it
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started}));
  rig.put(7);
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::ended}));
  EXPECT_EQ(rig.sweep.swept().size(), 4U);
}

TEST(Acquisition, TheSweepsLedgerHasWhatHappenedBetweenPressAndRelease) {
  Rig rig;
  rig.put(1);
  rig.put(2, 1);  // duplicate before the press
  rig.put(3);
  rig.put(4, 3);  // duplicate after it, known before the press is
  rig.acquisition.begin_sweep(at_ms(120));
  rig.put(8);  // 3 missing
  rig.put(9, 8);
  rig.put(10);
  rig.put(11, 10);  // after the release
  rig.put(15);
  rig.acquisition.end_sweep(at_ms(400));
  rig.put(16);
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started, Notice::Kind::ended}));
  ASSERT_NE(rig.sweep.ledger(), nullptr);
  const LossLedger& ledger = *rig.sweep.ledger();
  EXPECT_EQ(ledger.received, 5U);
  EXPECT_EQ(ledger.stored, 3U);
  EXPECT_EQ(ledger.stored, rig.sweep.swept().size());
  EXPECT_EQ(ledger.lost_for(LossCause::duplicate), 2U);
  EXPECT_EQ(ledger.device_gap, 3U);
  EXPECT_TRUE(ledger.balanced());
}

TEST(Acquisition, AFullMemoryIsToldOnceAndBookedOnTheSweep) {
  Rig rig(test::small_cart().acquisition, 24 + 6);
  rig.acquisition.begin_sweep(at_ms(0));
  for (std::uint64_t n = 1; n <= 8; ++n) rig.put(n);
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started, Notice::Kind::full}));
  rig.acquisition.end_sweep(at_ms(280));  // the first refused
  ASSERT_NE(rig.sweep.ledger(), nullptr);
  EXPECT_EQ(rig.sweep.swept().size(), 6U);
  EXPECT_EQ(rig.sweep.ledger()->lost_for(LossCause::ring_full), 1U);
  EXPECT_TRUE(rig.sweep.ledger()->balanced());
  EXPECT_EQ(rig.acquisition.ledger().stored, 8U) << "the live view had them all";
  EXPECT_EQ(rig.acquisition.begin_sweep(at_ms(330)), 2);
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::ended, Notice::Kind::refused}));
  EXPECT_EQ(rig.acquisition.ledger().presses_refused, 1U);
  rig.acquisition.end_sweep(at_ms(340));
  rig.sweep = {};
  rig.acquisition.begin_sweep(at_ms(400));
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started}));
  rig.acquisition.stop(at_ms(500));
}

TEST(Acquisition, StopEndsTheSweepAndBooksWhatStillWaited) {
  Rig rig;
  for (std::uint64_t n = 1; n <= 5; ++n) rig.put(n);
  rig.acquisition.begin_sweep(at_ms(100));
  const Picture six(6);
  rig.acquisition.on_frame(rig.frame(6, six), at_ms(241));
  rig.acquisition.stop(at_ms(242));
  EXPECT_EQ(rig.notices(), Kinds({Notice::Kind::started, Notice::Kind::ended}));
  EXPECT_EQ(rig.sweep.swept().size(), 3U);
  EXPECT_EQ(rig.sweep.ledger()->lost_for(LossCause::stopped), 1U);
  EXPECT_TRUE(rig.sweep.ledger()->balanced());
  EXPECT_FALSE(rig.acquisition.busy());
}

// The law of the ledger, and no heap, under everything at once.
TEST(Acquisition, EveryFrameIsAccountedForAndNothingIsAllocated) {
  std::mt19937_64 random(9);
  std::vector<Picture> pictures;
  for (std::uint64_t n = 0; n < 19; ++n) pictures.emplace_back(n);
  for (int run = 0; run < 20; ++run) {
    FrameRing ring(test::small_ring(60));
    AcquisitionSettings settings = test::small_cart().acquisition;
    settings.pairing.latency_offset = milliseconds(run * 10);
    Acquisition acquisition(ring, settings);
    std::array<Sweep, 4> kept;
    std::size_t next_kept = 0;
    bool recording = false;
    std::uint64_t given = 0;
    std::uint64_t sequence = 0;
    Stamp now = at_ms(1000);
    Stamp last_command = now;
    const ::sonoband::test::AllocationCounter allocations;
    for (int i = 0; i < 1500; ++i) {
      now += milliseconds(random() % 12);
      const auto what = random() % 16;
      if (what < 8) {
        if (random() % 10 != 0) acquisition.on_pose(reading(now - milliseconds(random() % 9)), now);
      } else if (what < 13) {
        ++given;
        sequence += random() % 20 == 0 ? random() % 5 : 1;
        Frame f =
            pictures[random() % pictures.size()].frame(sequence, now - milliseconds(random() % 50), now);
        if (random() % 30 == 0) f.width = 1;
        if (random() % 30 == 0) f.format = PixelFormat::mjpeg;
        acquisition.on_frame(f, now);
      } else if (what == 13 && random() % 4 == 0) {
        last_command = std::max(last_command, now - milliseconds(random() % 300));
        if (recording)
          acquisition.end_sweep(last_command);
        else
          acquisition.begin_sweep(last_command);
        recording = !recording;
      } else {
        acquisition.tick(now);
      }
      while (auto notice = acquisition.take_notice()) {
        if (notice->kind == Notice::Kind::started) kept[next_kept++ % kept.size()] = std::move(notice->sweep);
      }
      ASSERT_EQ(acquisition.ledger().received + acquisition.status(now).waiting, given);
      ASSERT_TRUE(acquisition.ledger().balanced());
    }
    acquisition.stop(now);
    EXPECT_EQ(allocations.count(), 0U);
    EXPECT_EQ(acquisition.ledger().received, given);
    while (auto notice = acquisition.take_notice()) {
      if (notice->kind == Notice::Kind::started) kept[next_kept++ % kept.size()] = std::move(notice->sweep);
    }
    EXPECT_GT(next_kept, 0U);
    for (const Sweep& sweep : kept) {
      if (!sweep) continue;
      ASSERT_NE(sweep.ledger(), nullptr);
      EXPECT_TRUE(sweep.ledger()->balanced());
      EXPECT_EQ(sweep.ledger()->stored, sweep.swept().size());
      EXPECT_EQ(sweep.ledger()->with(PoseStatus::ok), sweep.view().frames.size());
    }
  }
}

}  // namespace
}  // namespace sonoband::cart
