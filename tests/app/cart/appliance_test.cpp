#include "app/cart/appliance.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hal/sim/sim_footswitch.h"
#include "hal/sim/sim_frame_source.h"
#include "hal/sim/virtual_clock.h"
#include "tests/app/cart/cart_support.h"
#include "tests/support/allocation_counter.h"

namespace sonoband::cart {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::source_height;
using test::source_width;

// A tracker of 240 Hz that moves 20 mm/s along z, silent within `silent` (from start).
class PlainTracker final : public Tracker {
 public:
  explicit PlainTracker(Clock& clock, std::pair<Duration, Duration> silent = {})
      : clock_(clock), silent_(silent) {}
  void start() override { started_ = next_ = clock_.now(); }
  ReadStatus read(std::span<PoseSample> out, std::size_t& count, Duration timeout) override {
    count = 0;
    const Stamp until = clock_.now() + timeout;
    clock_.sleep_until(std::min(next_, until));
    for (; next_ <= clock_.now() && count < out.size(); next_ += from_seconds(1.0 / 240)) {
      const Duration t = next_ - started_;
      if (t < silent_.first || t >= silent_.second) out[count++] = test::reading(next_);
    }
    return count > 0 ? ReadStatus::ok : ReadStatus::nothing_yet;
  }
  DeviceHealth health() const override { return {.state = DeviceState::running}; }
  void stop() override {}

 private:
  Clock& clock_;
  std::pair<Duration, Duration> silent_;
  Stamp started_{};
  Stamp next_{};
};

// Passes another source on and counts what its thread allocates between one read and the next. Within a read
// the simulated clock keeps a list of its sleepers.
class CountingSource final : public FrameSource {
 public:
  CountingSource(std::unique_ptr<FrameSource> source, std::uint64_t& allocated, std::uint64_t& frames)
      : source_(std::move(source)), allocated_(allocated), frames_(frames) {}
  void start() override { source_->start(); }
  ReadStatus read(Frame& out, Duration timeout) override {
    allocated_ += counter_ ? counter_->count() : 0;
    const ReadStatus status = source_->read(out, timeout);
    frames_ += status == ReadStatus::ok ? 1 : 0;
    counter_.emplace();
    return status;
  }
  DeviceHealth health() const override { return source_->health(); }
  void stop() override { source_->stop(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::uint64_t& allocated_;
  std::uint64_t& frames_;
  std::optional<::sonoband::test::AllocationCounter> counter_;
};

void paint(Stamp captured, std::uint8_t* out, std::ptrdiff_t stride_bytes) {
  const auto n = static_cast<std::uint64_t>(captured.time_since_epoch() / milliseconds(1));
  for (int y = 0; y < source_height; ++y)
    for (int x = 0; x < source_width; ++x)
      out[y * stride_bytes + x] = static_cast<std::uint8_t>(x * 7 + y * 3 + n * 2);
}

struct Parts {
  std::shared_ptr<Clock> clock = std::make_shared<sim::VirtualClock>();
  sim::FootswitchSettings pedal = {};
  sim::FrameSourceSettings frames = {.width_px = source_width, .height_px = source_height};
  std::pair<Duration, Duration> tracker_silent = {};
  ApplianceSettings settings = {
      .ring = test::small_ring(400), .cart = test::small_cart(), .lock_memory = false};

  Devices devices() const {
    Devices d;
    d.clock = clock;
    d.tracker = std::make_unique<PlainTracker>(*clock, tracker_silent);
    d.frames = std::make_unique<sim::SimFrameSource>(*clock, frames, paint);
    d.pedal = std::make_unique<sim::SimFootswitch>(*clock, pedal);
    return d;
  }
};

// Sleeps on the clock, a little at a time, until the state comes.
bool await(Appliance& appliance, State state, Duration at_most = seconds(20)) {
  const Stamp until = appliance.clock().now() + at_most;
  while (appliance.status().cart.state != state) {
    if (appliance.clock().now() > until) return false;
    appliance.clock().sleep_until(appliance.clock().now() + milliseconds(10));
  }
  return true;
}

TEST(Appliance, AnExaminationFromPowerUpToReview) {
  Parts parts;
  parts.pedal.script = {{seconds(2), milliseconds(3500)}};
  const ClockMember member(*parts.clock);
  const Stamp begin = parts.clock->now();
  std::vector<bool> recordings;
  Devices devices = parts.devices();
  devices.on_recording = [&](bool on) { recordings.push_back(on); };
  Appliance appliance(std::move(devices), parts.settings);
  EXPECT_EQ(appliance.status().cart.state, State::idle);
  EXPECT_FALSE(appliance.latest());
  appliance.start();
  ASSERT_TRUE(await(appliance, State::live));
  ASSERT_TRUE(await(appliance, State::recording));
  EXPECT_LT(parts.clock->now() - begin, milliseconds(2100));
  const std::optional<Sweep> sweep = appliance.take_sweep();
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->pressed(), begin + seconds(2));
  EXPECT_FALSE(sweep->released());
  ASSERT_TRUE(await(appliance, State::review));
  parts.clock->sleep_until(begin + seconds(4));
  ASSERT_TRUE(sweep->released());
  EXPECT_EQ(*sweep->released(), begin + milliseconds(3500));

  // Frames are captured every 1/30 s from start; 2 to 3.5 s hold frames 60 to 105.
  EXPECT_EQ(sweep->swept().size(), 46U);
  EXPECT_EQ(sweep->view().frames.size(), 46U);
  EXPECT_EQ(sweep->pre_roll().size(), 30U);
  Stamp before = sweep->pressed() - from_seconds(1.0 / 30);
  for (const SweepFrame& f : sweep->swept()) {
    EXPECT_LE(f.tracked.captured - before, from_seconds(1.0 / 30) + std::chrono::nanoseconds(2));
    before = f.tracked.captured;
    EXPECT_NEAR(f.tracked.world_from_image.translation.z(), 20 * sonoband::seconds(f.tracked.captured), 1e-3);
  }
  EXPECT_EQ(sweep->ledger()->stored, 46U);
  EXPECT_TRUE(sweep->ledger()->balanced());

  const ApplianceStatus& status = appliance.status();
  EXPECT_NEAR(status.frames.hz, 30, 1.5);
  EXPECT_NEAR(status.tracker.hz, 240, 5);
  EXPECT_EQ(status.frames.health.state, DeviceState::running);
  ASSERT_TRUE(status.frames.age);
  EXPECT_LT(*status.frames.age, milliseconds(60));
  EXPECT_TRUE(status.cart.pedal_armed);
  EXPECT_FALSE(status.frozen);
  EXPECT_NEAR(status.cart.ring_seconds, (400 - 24 - 78) / 30.0, 1.0);
  EXPECT_TRUE(appliance.latest());

  ASSERT_TRUE(appliance.command(Command::show_live));
  EXPECT_TRUE(await(appliance, State::live));
  appliance.stop();
  EXPECT_EQ(recordings, std::vector<bool>({true, false}));
  const LossLedger& ledger = appliance.status().cart.acquisition.ledger;
  EXPECT_TRUE(ledger.balanced());
  EXPECT_EQ(ledger.received, appliance.status().frames.health.delivered);
}

TEST(Appliance, SameSeedSameSweep) {
  std::vector<std::vector<std::int64_t>> runs;
  for (int run = 0; run < 2; ++run) {
    Parts parts;
    parts.pedal.script = {{milliseconds(1500), milliseconds(2500)}};
    const ClockMember member(*parts.clock);
    Appliance appliance(parts.devices(), parts.settings);
    appliance.start();
    ASSERT_TRUE(await(appliance, State::review));
    appliance.stop();
    const auto sweep = appliance.take_sweep();
    ASSERT_TRUE(sweep);
    runs.emplace_back();
    for (const SweepFrame& f : sweep->swept()) {
      runs.back().push_back(f.raw.arrived.time_since_epoch().count());
      runs.back().push_back(f.tracked.captured.time_since_epoch().count());
      runs.back().push_back(f.tracked.bscan.pixels(3, 3));
    }
  }
  EXPECT_GT(runs[0].size(), 80U);
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(Appliance, TheCaptureThreadTakesNoHeap) {
  Parts parts;
  parts.pedal.script = {{milliseconds(500), milliseconds(900)}, {milliseconds(1200), milliseconds(1900)}};
  std::uint64_t allocated = 0;
  std::uint64_t frames = 0;
  {
    const ClockMember member(*parts.clock);
    Devices devices = parts.devices();
    devices.frames = std::make_unique<CountingSource>(std::move(devices.frames), allocated, frames);
    Appliance appliance(std::move(devices), parts.settings);
    appliance.start();
    parts.clock->sleep_until(parts.clock->now() + milliseconds(2500));
    appliance.stop();
    EXPECT_EQ(appliance.status().sweeps_handed, 2U);
  }
  EXPECT_EQ(allocated, 0U);
  EXPECT_GT(frames, 70U);
}

TEST(Appliance, AnUnpluggedPedalEndsTheSweep) {
  Parts parts;
  parts.pedal.script = {{seconds(1), seconds(8)}};
  parts.pedal.faults = {{sim::PedalFault::Kind::unplug, seconds(2), seconds(5)}};
  const ClockMember member(*parts.clock);
  const Stamp begin = parts.clock->now();
  Appliance appliance(parts.devices(), parts.settings);
  appliance.start();
  ASSERT_TRUE(await(appliance, State::review));
  EXPECT_EQ(appliance.status().cart.note, Note::pedal_lost);
  EXPECT_EQ(appliance.status().pedal.health.state, DeviceState::absent);
  parts.clock->sleep_until(begin + seconds(7));
  EXPECT_EQ(appliance.status().cart.state, State::review) << "down when it came back: not a press";
  const auto sweep = appliance.take_sweep();
  ASSERT_TRUE(sweep && sweep->released());
  EXPECT_LT(*sweep->released() - begin, milliseconds(2100));
  EXPECT_FALSE(appliance.take_sweep());
  appliance.stop();
}

TEST(Appliance, ASilentTrackerLeavesFramesWithoutPose) {
  Parts parts;
  parts.pedal.script = {{seconds(1), seconds(3)}};
  parts.tracker_silent = {milliseconds(1500), milliseconds(2500)};
  const ClockMember member(*parts.clock);
  Appliance appliance(parts.devices(), parts.settings);
  appliance.start();
  ASSERT_TRUE(await(appliance, State::review));
  parts.clock->sleep_until(parts.clock->now() + milliseconds(500));
  const auto sweep = appliance.take_sweep();
  ASSERT_TRUE(sweep && sweep->ledger() != nullptr);
  EXPECT_EQ(sweep->swept().size(), 61U);
  EXPECT_EQ(sweep->view().frames.size(), 31U);
  EXPECT_EQ(sweep->ledger()->with(PoseStatus::not_yet) + sweep->ledger()->with(PoseStatus::gap), 30U);
  appliance.stop();
}

TEST(Appliance, LostPicturesEndTheRecordingAndIdleTheCart) {
  Parts parts;
  parts.pedal.script = {{seconds(1), seconds(9)}};
  parts.frames.faults = {{.kind = sim::FrameFault::Kind::cable_out, .from = seconds(2), .until = seconds(5)}};
  const ClockMember member(*parts.clock);
  Appliance appliance(parts.devices(), parts.settings);
  appliance.start();
  ASSERT_TRUE(await(appliance, State::review));
  EXPECT_EQ(appliance.status().cart.note, Note::frames_lost);
  ASSERT_TRUE(appliance.command(Command::show_live));
  ASSERT_TRUE(await(appliance, State::idle));
  ASSERT_TRUE(await(appliance, State::live)) << "the cable is back";
  appliance.stop();
}

TEST(Appliance, AFrozenScannerIsToldFromALostOne) {
  Parts parts;
  parts.frames.faults = {{.kind = sim::FrameFault::Kind::freeze, .from = seconds(1), .until = seconds(4)}};
  const ClockMember member(*parts.clock);
  Appliance appliance(parts.devices(), parts.settings);
  appliance.start();
  parts.clock->sleep_until(parts.clock->now() + seconds(3));
  EXPECT_TRUE(appliance.status().frozen);
  EXPECT_EQ(appliance.status().cart.state, State::live);
  EXPECT_GT(appliance.status().cart.acquisition.ledger.lost_for(LossCause::duplicate), 50U);
  parts.clock->sleep_until(parts.clock->now() + seconds(2));
  EXPECT_FALSE(appliance.status().frozen);
  appliance.stop();
}

TEST(Appliance, StopEndsARecordingAndMayBeCalledTwiceOrNever) {
  Parts parts;
  parts.pedal.script = {{seconds(1), seconds(9)}};
  const ClockMember member(*parts.clock);
  { const Appliance never_started(parts.devices(), parts.settings); }
  Appliance appliance(parts.devices(), parts.settings);
  appliance.start();
  ASSERT_TRUE(await(appliance, State::recording));
  parts.clock->sleep_until(parts.clock->now() + milliseconds(500));
  appliance.stop();
  appliance.stop();
  const auto sweep = appliance.take_sweep();
  ASSERT_TRUE(sweep && sweep->ledger() != nullptr);
  EXPECT_GT(sweep->swept().size(), 10U);
  EXPECT_NE(appliance.status().cart.state, State::recording);
}

// Threads that truly run at once: for the thread sanitizer. Nothing here depends on how fast.
TEST(Appliance, RunsOnTheRealClockWithReadersAtWork) {
  Parts parts;
  parts.clock = std::make_shared<SystemClock>();
  parts.frames.rate_hz = 60;
  Devices devices = parts.devices();
  auto* pedal = static_cast<sim::SimFootswitch*>(devices.pedal.get());
  Appliance appliance(std::move(devices), parts.settings);
  appliance.start();
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> seen{0};
  std::thread live_view([&] {
    while (!over) {
      if (const FrameLease lease = appliance.latest()) seen += 1U + lease.frame().tracked.bscan.pixels(0, 0);
      std::this_thread::sleep_for(milliseconds(2));
    }
  });
  ASSERT_TRUE(await(appliance, State::live));
  while (!appliance.status().cart.pedal_armed) std::this_thread::sleep_for(milliseconds(2));
  ASSERT_TRUE(pedal->press());
  ASSERT_TRUE(await(appliance, State::recording));
  std::optional<Sweep> sweep;
  while (!sweep) sweep = appliance.take_sweep();
  std::uint64_t sum = 0;
  // At least once: this thread may come so late that they are all there.
  do {
    for (const TrackedFrame* f : sweep->view().frames) sum += f->bscan.pixels(1, 1);
    std::this_thread::sleep_for(milliseconds(1));
  } while (sweep->swept().size() < 8);
  ASSERT_TRUE(pedal->release());
  ASSERT_TRUE(await(appliance, State::review));
  while (!sweep->released()) std::this_thread::sleep_for(milliseconds(2));
  EXPECT_TRUE(sweep->ledger()->balanced());
  over = true;
  live_view.join();
  appliance.stop();
  EXPECT_GT(sum, 0U);
  EXPECT_GT(seen, 0U);
}

TEST(LockedMemory, ARefusalNamesSizeReasonAndCure) {
  const std::string sentence = lock_refused((std::size_t{370} << 20) - 5, ENOMEM);
  EXPECT_NE(sentence.find("370 MB"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("Cannot allocate memory"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("ulimit -l"), std::string::npos) << sentence;
}

// Whether the system allows it or not; the sanitizers make mlock do nothing and succeed.
TEST(LockedMemory, WorksOrSaysWhyNot) {
  std::vector<std::byte> small(4096);
  const LockedMemory locked(small);
  EXPECT_EQ(locked.locked(), locked.warning().empty());
}

}  // namespace
}  // namespace sonoband::cart
