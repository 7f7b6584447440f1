// The simulated board delivers: frames, poses and a pedal's edges, on a clock that jumps.
#include "board/devices.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/replay/replay.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

TEST(SimBoard, DeliversFramesPosesAndEdges) {
  sim::VirtualClock clock;
  BoardDevices devices = make_sim_board({}, clock);
  EXPECT_GT(seconds(devices.latency_offset), 0.05);
  EXPECT_FALSE(devices.mask.view().empty());

  devices.frames->start();
  Frame frame;
  ASSERT_EQ(devices.frames->read(frame, std::chrono::seconds(2)), ReadStatus::ok);
  EXPECT_EQ(frame.width, devices.width_px);
  EXPECT_EQ(frame.height, devices.height_px);
  devices.frames->stop();

  devices.tracker->start();
  std::array<PoseSample, 64> poses;
  std::size_t count = 0;
  const Stamp end = clock.now() + std::chrono::seconds(10);
  while (count == 0 && clock.now() < end) devices.tracker->read(poses, count, std::chrono::milliseconds(100));
  ASSERT_GT(count, 0u);
  EXPECT_TRUE(usable(poses[0].quality));
  devices.tracker->stop();

  devices.footswitch->start();
  ASSERT_TRUE(devices.foot(true));
  PedalEdge edge;
  ASSERT_EQ(devices.footswitch->read(edge, std::chrono::seconds(1)), ReadStatus::ok);
  devices.footswitch->stop();
}

TEST(SimBoard, TheProfilesLatencyOutranksTheScenes) {
  sim::VirtualClock clock;
  Profile profile;
  profile.capture.latency_ms = 120;
  EXPECT_EQ(make_sim_board(profile, clock).latency_offset, std::chrono::milliseconds(120));
}

TEST(ReplayBoard, PlaysARecording) {
  sim::VirtualClock clock;
  static const std::array<std::uint8_t, 6> pixels{1, 2, 3, 4, 5, 6};
  auto recording = std::make_shared<Recording>();
  recording->frames.push_back({.data = pixels.data(), .width = 3, .height = 2, .stride_bytes = 3});
  recording->poses.push_back({});
  BoardDevices devices = make_replay_board(recording, {}, {}, {}, clock);
  EXPECT_EQ(devices.width_px, 3);
  devices.frames->start();
  Frame frame;
  ASSERT_EQ(devices.frames->read(frame, std::chrono::seconds(1)), ReadStatus::ok);
  EXPECT_EQ(frame.data[4], 5);
  devices.frames->stop();
}

}  // namespace
}  // namespace sonoband
