#include "hal/replay/replay.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Stamp origin(std::chrono::hours(1));
const Stamp recorded(std::chrono::hours(400));

// 10 frames every 40 ms, the first 20 ms after the first of 101 poses every 4 ms; frame 5 was lost.
std::shared_ptr<const Recording> example() {
  auto r = std::make_shared<Recording>();
  auto pixels = std::make_shared<std::vector<std::uint8_t>>();
  pixels->resize(10 * 12);
  for (std::uint64_t i = 0; i < 10; ++i) {
    std::uint8_t* data = pixels->data() + 12 * i;
    data[0] = static_cast<std::uint8_t>(i);
    r->frames.push_back({.data = data,
                         .width = 4,
                         .height = 3,
                         .stride_bytes = 4,
                         .captured = recorded + milliseconds(20 + 40 * static_cast<int>(i)),
                         .sequence = i < 5 ? i : i + 1});
  }
  r->pixels = pixels;
  for (int i = 0; i <= 100; ++i) {
    RecordedPose p{.time = recorded + milliseconds(4 * i)};
    p.tracker_from_probe.translation.x() = i;
    p.quality = i == 50 ? PoseQuality::distorted : PoseQuality::good;
    r->poses.push_back(p);
  }
  return r;
}

TEST(Replay, PosesAndFramesKeepTheirDistancesInTime) {
  sim::VirtualClock clock(origin);
  const auto timeline = std::make_shared<ReplayTimeline>(clock, example(), ReplayMode::once);
  ReplayTracker tracker(timeline);
  ReplayFrameSource source(timeline);
  tracker.start();
  clock.sleep_until(origin + milliseconds(7));  // the second to start joins the first one's timeline
  source.start();

  std::array<PoseSample, 16> poses;
  std::size_t count = 0;
  std::size_t seen = 0;
  ReadStatus status = tracker.read(poses, count, milliseconds(100));
  for (; status == ReadStatus::ok; status = tracker.read(poses, count, milliseconds(100))) {
    for (std::size_t i = 0; i < count; ++i, ++seen) {
      EXPECT_EQ(poses[i].time, origin + milliseconds(4) * seen);
      EXPECT_EQ(poses[i].tracker_from_probe.translation.x(), static_cast<double>(seen));
      EXPECT_EQ(usable(poses[i].quality), seen != 50);
    }
  }
  EXPECT_EQ(status, ReadStatus::ended);
  EXPECT_EQ(seen, 101U);

  Frame f;
  for (std::uint64_t i = 0; i < 10; ++i) {
    ASSERT_EQ(source.read(f, seconds(1)), ReadStatus::ok);
    EXPECT_EQ(f.captured, origin + milliseconds(20) + milliseconds(40) * i);
    EXPECT_EQ(f.data[0], i);
    EXPECT_EQ(f.bytes, 12U);
  }
  EXPECT_EQ(source.read(f, seconds(1)), ReadStatus::ended);
  EXPECT_EQ(source.health().lost, 1U);
  EXPECT_EQ(source.health().delivered, 10U);
}

TEST(Replay, WaitsNoLongerThanAsked) {
  sim::VirtualClock clock(origin);
  const auto timeline = std::make_shared<ReplayTimeline>(clock, example(), ReplayMode::once);
  ReplayFrameSource source(timeline);
  source.start();
  Frame f;
  EXPECT_EQ(source.read(f, milliseconds(10)), ReadStatus::nothing_yet);
  EXPECT_EQ(clock.now(), origin + milliseconds(10));
  EXPECT_EQ(source.read(f, milliseconds(10)), ReadStatus::ok);
}

TEST(Replay, ALoopGoesOnWithNewEpochsAndRisingNumbers) {
  sim::VirtualClock clock(origin);
  const auto timeline = std::make_shared<ReplayTimeline>(clock, example(), ReplayMode::loop);
  ReplayTracker tracker(timeline);
  ReplayFrameSource source(timeline);
  tracker.start();
  source.start();
  std::array<PoseSample, 1> pose;
  std::size_t count = 0;
  Stamp last = origin - milliseconds(4);
  for (std::uint32_t i = 0; i < 303; ++i) {
    ASSERT_EQ(tracker.read(pose, count, seconds(1)), ReadStatus::ok);
    EXPECT_EQ(pose[0].epoch, i / 101);
    EXPECT_GT(pose[0].time, last);
    last = pose[0].time;
  }
  Frame f;
  std::uint64_t sequence = 0;
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(source.read(f, seconds(1)), ReadStatus::ok);
    if (i > 0) {
      EXPECT_EQ(f.sequence, sequence + (i % 10 == 5 ? 2 : 1));
    }
    sequence = f.sequence;
  }
  EXPECT_EQ(source.health().lost, 3U);
}

}  // namespace
}  // namespace sonoband
