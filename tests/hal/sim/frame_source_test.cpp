#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "hal/sim/sim_frame_source.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband::sim {
namespace {

using Kind = FrameFault::Kind;
using std::chrono::milliseconds;
using std::chrono::seconds;

const Stamp origin(std::chrono::hours(1));

// A source of 8 x 4 pictures whose first byte counts paintings.
struct Rig {
  VirtualClock clock{origin};
  int paintings = 0;
  SimFrameSource source;

  explicit Rig(std::vector<FrameFault> faults = {}, double rate_hz = 50)
      : source(clock, settings(std::move(faults), rate_hz),
               [this](Stamp, std::uint8_t* out, std::ptrdiff_t stride) {
                 std::fill_n(out, 4 * stride, static_cast<std::uint8_t>(++paintings));
               }) {
    source.start();
  }
  static FrameSourceSettings settings(std::vector<FrameFault> faults, double rate_hz) {
    FrameSourceSettings s;
    s.width_px = 8;
    s.height_px = 4;
    s.rate_hz = rate_hz;
    s.faults = std::move(faults);
    return s;
  }
  struct Got {
    Frame frame;
    std::uint8_t value;
  };
  std::vector<Got> run(Duration time) {
    std::vector<Got> all;
    while (clock.now() < origin + time) {
      Frame f;
      if (source.read(f, milliseconds(7)) != ReadStatus::ok) continue;
      EXPECT_GE(clock.now(), f.arrived);
      all.push_back({f, f.data[0]});
    }
    return all;
  }
};

TEST(SimFrameSource, DeliversAtItsRateWithLatencyAndBoundedJitter) {
  for (const double rate : {25.0, 30.0, 50.0, 60.0}) {
    Rig rig({}, rate);
    const auto frames = rig.run(seconds(2));
    EXPECT_NEAR(static_cast<double>(frames.size()), 2 * rate - 0.027 * rate, 2);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Frame& f = frames[i].frame;
      EXPECT_EQ(f.sequence, i);
      EXPECT_NEAR(sonoband::seconds(f.captured - origin), static_cast<double>(i) / rate, 1e-9) << rate;
      EXPECT_GE(f.arrived - f.captured, milliseconds(25));
      EXPECT_LE(f.arrived - f.captured, milliseconds(27));
      EXPECT_NEAR(static_cast<double>(f.device_stamp_ns) * 1e-9, static_cast<double>(i) / rate * (1 + 40e-6),
                  1e-8);
    }
    EXPECT_EQ(rig.source.health().state, DeviceState::running);
    EXPECT_EQ(rig.source.health().delivered, frames.size());
    EXPECT_EQ(rig.source.health().lost, 0U);
  }
}

TEST(SimFrameSource, NothingYetComesAtTheDeadline) {
  Rig rig;
  Frame f;
  EXPECT_EQ(rig.source.read(f, milliseconds(10)), ReadStatus::nothing_yet);
  EXPECT_EQ(rig.clock.now(), origin + milliseconds(10));
}

TEST(SimFrameSource, ADropIsAJumpOfTheSequence) {
  Rig rig({{.kind = Kind::drop, .from = milliseconds(200), .until = milliseconds(260)}});
  const auto frames = rig.run(seconds(1));
  EXPECT_EQ(frames[9].frame.sequence, 9U);
  EXPECT_EQ(frames[10].frame.sequence, 13U);
  EXPECT_EQ(rig.source.health().lost, 3U);
}

TEST(SimFrameSource, AFrozenPictureComesWithNewStamps) {
  Rig rig({{.kind = Kind::freeze, .from = milliseconds(200), .until = milliseconds(260)}});
  const auto frames = rig.run(seconds(1));
  for (std::size_t i = 10; i < 13; ++i) {
    EXPECT_EQ(frames[i].value, frames[9].value);
    EXPECT_EQ(frames[i].frame.sequence, i);
  }
  EXPECT_NE(frames[13].value, frames[9].value);
}

TEST(SimFrameSource, LateFramesKeepTheirStampAndOrder) {
  Rig rig(
      {{.kind = Kind::late, .from = milliseconds(200), .until = milliseconds(220), .by = milliseconds(300)}});
  const auto frames = rig.run(seconds(1));
  EXPECT_EQ(frames[10].frame.captured, origin + milliseconds(200));
  EXPECT_GE(frames[10].frame.arrived - frames[10].frame.captured, milliseconds(325));
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].frame.sequence, i);
    EXPECT_GE(frames[i].frame.arrived, frames[i - 1].frame.arrived);
  }
}

TEST(SimFrameSource, AStallIsSeenAndEnds) {
  Rig rig({{.kind = Kind::stall, .from = milliseconds(200), .until = milliseconds(700)}});
  const auto before = rig.run(milliseconds(500));
  EXPECT_EQ(before.size(), 10U);
  EXPECT_EQ(rig.source.health().state, DeviceState::stalled);
  const auto after = rig.run(seconds(1));
  ASSERT_FALSE(after.empty());
  EXPECT_EQ(after[0].frame.sequence, 10U);
  EXPECT_EQ(after[0].frame.captured, origin + milliseconds(700));
  EXPECT_EQ(rig.source.health().state, DeviceState::running);
  EXPECT_EQ(rig.source.health().recoveries, 1U);
}

TEST(SimFrameSource, UnpluggedItIsAbsentAndComesBackFromNought) {
  Rig rig({{.kind = Kind::unplug, .from = milliseconds(200), .until = milliseconds(700)}});
  rig.run(milliseconds(500));
  EXPECT_EQ(rig.source.health().state, DeviceState::absent);
  EXPECT_STRNE(rig.source.health().reason, "");
  const auto after = rig.run(seconds(1));
  EXPECT_EQ(after.at(0).frame.sequence, 0U);
}

TEST(SimFrameSource, WithoutTheCableItSaysSo) {
  Rig rig({{.kind = Kind::cable_out, .from = milliseconds(200), .until = milliseconds(700)}});
  rig.run(milliseconds(500));
  EXPECT_EQ(rig.source.health().state, DeviceState::fault);
  EXPECT_STREQ(rig.source.health().reason, "No signal from the scanner: check the video cable.");
  EXPECT_FALSE(rig.run(seconds(1)).empty());
  EXPECT_EQ(rig.source.health().state, DeviceState::running);
}

TEST(SimFrameSource, TheScannersOutputMayChangeItsSize) {
  Rig rig(
      {{.kind = Kind::resize, .from = milliseconds(200), .until = seconds(9), .width = 12, .height = 10}});
  const auto frames = rig.run(milliseconds(500));
  EXPECT_EQ(frames[9].frame.width, 8);
  EXPECT_EQ(frames[10].frame.width, 12);
  EXPECT_EQ(frames[10].frame.height, 10);
  EXPECT_EQ(frames[10].frame.bytes, 120U);
  EXPECT_EQ(frames[10].frame.data[119], frames[10].frame.data[0]);
}

TEST(SimFrameSource, ASlowReaderLosesTheOldestAndCountsThem) {
  Rig rig;
  rig.run(milliseconds(300));
  rig.clock.sleep_until(origin + milliseconds(800));
  const auto after = rig.run(milliseconds(1200));
  std::uint64_t last = after.at(0).frame.sequence;
  EXPECT_GT(last, 25U);
  for (std::size_t i = 1; i < after.size(); ++i) EXPECT_EQ(after[i].frame.sequence, ++last);
  EXPECT_EQ(rig.source.health().lost + rig.source.health().delivered, last + 1);
}

}  // namespace
}  // namespace sonoband::sim
