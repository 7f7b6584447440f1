// A simulated tracker, its driver and a clock that jumps, and the judgement that every test passes its
// readings to: a usable pose is where the probe truly was at its time, whatever was done to the wire.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hal/sim/liberty_sim.h"
#include "hal/tracker/polhemus_tracker.h"

namespace sonoband::test {

// One thread's time: sleeping moves it.
class SteppedClock final : public Clock {
 public:
  Stamp now() override { return now_; }
  void sleep_until(Stamp t) override { now_ = std::max(now_, t); }

 private:
  Stamp now_{std::chrono::seconds(1000)};
};

inline Stamp at(double s) {
  return Stamp(std::chrono::seconds(1000)) + from_seconds(s);
}

// A hand at up to 90 mm/s and 40 degrees/s, 28 cm from the source, in its +X half.
inline Rigid<frame::Tracker, frame::Probe> hand(Stamp t) {
  const double s = seconds(t) - 1000;
  const Eigen::Vector3d p(250 + 30 * std::sin(2.1 * s), -80 + 25 * std::sin(1.3 * s + 1),
                          60 + 40 * std::cos(0.9 * s));
  const Eigen::Quaterniond q = Eigen::AngleAxisd(0.6 * std::sin(1.1 * s), Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(2.5 + 0.4 * std::cos(0.7 * s), Eigen::Vector3d::UnitX());
  return rigid<frame::Tracker, frame::Probe>(q, p);
}

class Rig {
 public:
  explicit Rig(const sim::LibertySimConfig& config = {}, const LinkConfig& link = {})
      : period_(config.unit.model == sim::TrackerModel::patriot ? 1.0 / 60
                : link.rate == RecordRate::hz_120               ? 1.0 / 120
                                                                : 1.0 / 240),
        model_(config.unit.model),
        drift_(1 + config.unit.clock_drift_ppm * 1e-6),
        port(clock, config, hand),
        tracker(port, clock, link) {}

  // Reads for `d` as the cart does, and judges what came.
  void run(double s) {
    const Stamp until = clock.now() + from_seconds(s);
    std::array<PoseSample, 64> batch;
    while (clock.now() < until) {
      std::size_t n = 0;
      const Duration patience = std::min<Duration>(std::chrono::milliseconds(20), until - clock.now());
      const ReadStatus status = tracker.read(batch, n, patience);
      EXPECT_EQ(status, n > 0 ? ReadStatus::ok : ReadStatus::nothing_yet);
      for (std::size_t i = 0; i < n; ++i) judge(batch[i]);
      samples.insert(samples.end(), batch.begin(), batch.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }
  // Until the probe's poses come again, at most `s`.
  bool run_until_good(double s) {
    const Stamp until = clock.now() + from_seconds(s);
    while (clock.now() < until) {
      const std::size_t before = samples.size();
      run(0.02);
      if (samples.size() > before && samples.back().quality == PoseQuality::good) return true;
    }
    return false;
  }

  void start() { tracker.start(); }
  std::uint32_t epoch() const { return samples.empty() ? 0 : samples.back().epoch; }
  DeviceState state() const { return tracker.health().state; }
  LinkReason reason() const { return tracker.link().reason(); }
  const LinkCounters& counters() const { return tracker.counters(); }
  std::size_t count(PoseQuality q) const {
    std::size_t n = 0;
    for (const PoseSample& s : samples) n += s.quality == q ? 1 : 0;
    return n;
  }

 private:
  Duration latency() const {
    return std::chrono::microseconds(model_ == sim::TrackerModel::patriot ? 18000 : 3500);
  }

  void judge(const PoseSample& s) {
    if (!samples.empty()) {
      const PoseSample& before = samples.back();
      EXPECT_GT(s.time, before.time);
      EXPECT_GE(s.epoch, before.epoch);
      if (s.epoch == before.epoch && s.quality != PoseQuality::missing) {
        const std::uint32_t frames = s.device_frame - before.device_frame;
        EXPECT_LT(frames, 0x80000000U) << "backwards within an epoch";
        EXPECT_NEAR(seconds(s.time - before.time), frames * period_ * drift_, period_ / 2 + 1e-3);
      }
    }
    if (s.quality == PoseQuality::missing) return;
    EXPECT_LE(s.time, s.arrived);
    if (!usable(s.quality)) return;
    const auto truth = hand(s.time - latency());
    const double off_mm = (s.tracker_from_probe.translation - truth.translation).norm();
    const double off_deg = Eigen::Quaterniond(s.tracker_from_probe.rotation)
                               .angularDistance(Eigen::Quaterniond(truth.rotation)) *
                           180 / M_PI;
    worst_mm = std::max(worst_mm, off_mm);
    worst_deg = std::max(worst_deg, off_deg);
    EXPECT_LT(off_mm, 0.2) << "frame " << s.device_frame << " at " << seconds(s.time) - 1000;
    EXPECT_LT(off_deg, 0.1);
  }

  double period_;
  sim::TrackerModel model_;
  double drift_;

 public:
  SteppedClock clock;
  sim::LibertySim port;
  PolhemusTracker tracker;
  std::vector<PoseSample> samples;
  double worst_mm = 0;
  double worst_deg = 0;
};

}  // namespace sonoband::test
