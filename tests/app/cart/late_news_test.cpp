// A press takes effect at its kernel stamp: whatever is delayed, the sweep has exactly the frames captured
// from press to release.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/app/cart/cart_support.h"

namespace sonoband::cart {
namespace {

using std::chrono::milliseconds;
using test::at_ms;

std::vector<Stamp> stamps(std::span<const SweepFrame> frames) {
  std::vector<Stamp> out;
  for (const SweepFrame& f : frames) out.push_back(f.raw.stamped);
  return out;
}

struct Delays {
  double frame_ms = 20;
  double pose_ms = 5;
  double pedal_ms = 0;
  double latency_ms = 0;  // scanner minus tracker
};

void sweep_is_exact(double hz, const Delays& delays, double press_ms, double release_ms) {
  SCOPED_TRACE(testing::Message() << hz << " Hz, pedal late by " << delays.pedal_ms << " ms, frames by "
                                  << delays.frame_ms << " ms, offset " << delays.latency_ms
                                  << " ms, press at " << press_ms << " ms, release at " << release_ms
                                  << " ms");
  CartSettings settings = test::small_cart();
  settings.acquisition.pairing.latency_offset = from_seconds(delays.latency_ms / 1000);
  FrameRing ring(test::small_ring(500));
  Cart cart(ring, settings);
  test::Timeline timeline;
  timeline.frames(hz, at_ms(0), at_ms(4000), from_seconds(delays.frame_ms / 1000));
  timeline.poses(at_ms(-500), at_ms(4100), from_seconds(delays.pose_ms / 1000));
  timeline.pedal_is_up(at_ms(-500));
  timeline.edge(at_ms(press_ms), true, from_seconds(delays.pedal_ms / 1000));
  timeline.edge(at_ms(release_ms), false, from_seconds(delays.pedal_ms / 1000));
  timeline.run(cart, at_ms(5000));

  const auto sweep = cart.take_sweep();
  ASSERT_TRUE(sweep);
  EXPECT_FALSE(cart.take_sweep()) << "one press, one sweep";
  EXPECT_EQ(sweep->pressed(), at_ms(press_ms));
  EXPECT_EQ(sweep->released(), at_ms(release_ms));
  EXPECT_TRUE(sweep->start_complete());
  std::vector<Stamp> want;
  std::vector<Stamp> before;
  for (const Stamp t : timeline.captured) {
    const Stamp shown = t - from_seconds(delays.latency_ms / 1000);
    if (shown >= at_ms(press_ms) && shown <= at_ms(release_ms)) want.push_back(t);
    if (shown < at_ms(press_ms) && shown >= at_ms(press_ms - 1000)) before.push_back(t);
  }
  EXPECT_EQ(stamps(sweep->swept()), want);
  EXPECT_EQ(stamps(sweep->pre_roll()), before);
  EXPECT_EQ(sweep->view().frames.size(), want.size()) << "all have poses";
  ASSERT_NE(sweep->ledger(), nullptr);
  EXPECT_EQ(sweep->ledger()->received, want.size());
  EXPECT_EQ(sweep->ledger()->stored, want.size());
  EXPECT_TRUE(sweep->ledger()->balanced());
}

TEST(LateNews, TheFirstFrameAfterThePressAndTheLastBeforeTheReleaseAreNeverLost) {
  for (const double hz : {25.0, 30.0, 60.0}) {
    const double period = 1000 / hz;
    for (const double pedal_ms : {0.0, 40.0, 150.0, 300.0}) {
      // At, just before and just after a frame, and between two.
      for (const double phase : {0.0, -0.01, 0.01, 0.5}) {
        const Delays delays{.pedal_ms = pedal_ms};
        sweep_is_exact(hz, delays, 1500 + phase * period, 2500 + phase * period);
      }
    }
  }
}

TEST(LateNews, NorWithAnyMixtureOfDelays) {
  std::mt19937_64 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 30; ++i) {
    const double hz = std::vector<double>{25, 30, 60}[random() % 3];
    const Delays delays{.frame_ms = between(0, 200),
                        .pose_ms = between(0, 80),
                        .pedal_ms = between(0, 300),
                        .latency_ms = between(-20, 250)};
    const double press_ms = 1300 + std::floor(between(0, 500));
    sweep_is_exact(hz, delays, press_ms, press_ms + std::floor(between(60, 1500)));
  }
}

TEST(LateNews, APressAndItsReleaseMayArriveTogetherAfterwards) {
  // 60 ms of pedal, both edges known 300 ms later: the whole sweep is in the past by then.
  sweep_is_exact(60, {.frame_ms = 10, .pedal_ms = 300}, 1500, 1560);
}

TEST(LateNews, TheNextPressMayComeBeforeTheLastSweepIsComplete) {
  // Frames 250 ms late: at the second press the first sweep still waits for its last frames.
  FrameRing ring(test::small_ring(500));
  CartSettings settings = test::small_cart();
  settings.acquisition.pre_roll = {};
  Cart cart(ring, settings);
  test::Timeline timeline;
  timeline.frames(30, at_ms(0), at_ms(4000), milliseconds(250));
  timeline.poses(at_ms(-500), at_ms(4100), {});
  timeline.pedal_is_up(at_ms(-500));
  timeline.edge(at_ms(1000), true, {});
  timeline.edge(at_ms(1500), false, {});
  timeline.edge(at_ms(1600), true, {});
  timeline.edge(at_ms(1700), false, {});
  timeline.edge(at_ms(1800), true, {});
  timeline.edge(at_ms(2500), false, {});
  timeline.run(cart, at_ms(5000));
  for (const auto& [press, release] : {std::pair{1000, 1500}, {1600, 1700}, {1800, 2500}}) {
    const auto sweep = cart.take_sweep();
    ASSERT_TRUE(sweep);
    std::vector<Stamp> want;
    for (const Stamp t : timeline.captured)
      if (t >= at_ms(press) && t <= at_ms(release)) want.push_back(t);
    EXPECT_EQ(stamps(sweep->swept()), want);
    ASSERT_NE(sweep->ledger(), nullptr);
    EXPECT_EQ(sweep->ledger()->received, want.size());
  }
  EXPECT_FALSE(cart.take_sweep());
  EXPECT_EQ(cart.state(), State::review);
}

}  // namespace
}  // namespace sonoband::cart
