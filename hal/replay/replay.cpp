#include "hal/replay/replay.h"

#include <algorithm>
#include <cassert>

namespace sonoband {

namespace {

constexpr Duration never = Duration::min();

}  // namespace

ReplayTimeline::ReplayTimeline(Clock& clock, std::shared_ptr<const Recording> recording, ReplayMode mode)
    : clock_(clock), recording_(std::move(recording)), mode_(mode), started_(never) {
  const auto& frames = recording_->frames;
  const auto& poses = recording_->poses;
  assert(!frames.empty() || !poses.empty());
  first_ = Stamp::max();
  Stamp last = Stamp::min();
  // Between laps one typical distance between readings passes.
  Duration step = std::chrono::milliseconds(1);
  const auto take = [&](Stamp from, Stamp to, std::size_t count) {
    first_ = std::min(first_, from);
    last = std::max(last, to);
    if (count > 1) step = std::max(step, (to - from) / static_cast<std::int64_t>(count - 1));
  };
  if (!frames.empty()) take(frames.front().captured, frames.back().captured, frames.size());
  if (!poses.empty()) take(poses.front().time, poses.back().time, poses.size());
  lap_ = last - first_ + step;
}

void ReplayTimeline::start() {
  Duration unset = never;
  started_.compare_exchange_strong(unset, clock_.now().time_since_epoch());
}

Stamp ReplayTimeline::play_time(Stamp recorded, std::uint32_t lap) const {
  return Stamp(started_.load()) + (recorded - first_) + lap * lap_;
}

void ReplayTracker::start() {
  timeline_->start();
  health_.state = DeviceState::running;
}

void ReplayTracker::stop() {
  health_.state = DeviceState::absent;
}

ReadStatus ReplayTracker::read(std::span<PoseSample> out, std::size_t& count, Duration timeout) {
  count = 0;
  Clock& clock = timeline_->clock();
  const auto& poses = timeline_->recording().poses;
  const Stamp deadline = clock.now() + timeout;
  while (count < out.size()) {
    if (next_ == poses.size() && timeline_->loops() && !poses.empty()) {
      next_ = 0;
      ++lap_;
    }
    if (next_ == poses.size()) return count > 0 ? ReadStatus::ok : ReadStatus::ended;
    const RecordedPose& p = poses[next_];
    const Stamp due = timeline_->play_time(p.time, lap_);
    if (clock.now() < due) {
      if (count > 0) break;
      clock.sleep_until(std::min(due, deadline));
      if (clock.now() < due) return ReadStatus::nothing_yet;
    }
    PoseSample& sample = out[count++];
    sample = {.time = due,
              .tracker_from_probe = p.tracker_from_probe,
              .quality = p.quality,
              .epoch = lap_,
              .device_frame = static_cast<std::uint32_t>(next_),
              .device_ms = 0,
              .arrived = due};
    ++next_;
    ++health_.delivered;
  }
  return ReadStatus::ok;
}

DeviceHealth ReplayTracker::health() const {
  return health_.read();
}

void ReplayFrameSource::start() {
  timeline_->start();
  health_.state = DeviceState::running;
}

void ReplayFrameSource::stop() {
  health_.state = DeviceState::absent;
}

ReadStatus ReplayFrameSource::read(Frame& out, Duration timeout) {
  Clock& clock = timeline_->clock();
  const auto& frames = timeline_->recording().frames;
  const Stamp deadline = clock.now() + timeout;
  if (next_ == frames.size() && timeline_->loops() && !frames.empty()) {
    next_ = 0;
    ++lap_;
    last_sequence_.reset();
  }
  if (next_ == frames.size()) return ReadStatus::ended;
  const RecordedFrame& f = frames[next_];
  const Stamp due = timeline_->play_time(f.captured, lap_);
  if (clock.now() < due) {
    clock.sleep_until(std::min(due, deadline));
    if (clock.now() < due) return ReadStatus::nothing_yet;
  }
  // Numbers go on from lap to lap, so that a lap's end is no loss.
  const std::uint64_t per_lap = frames.back().sequence - frames.front().sequence + 1;
  if (last_sequence_ && f.sequence > *last_sequence_ + 1) health_.lost += f.sequence - *last_sequence_ - 1;
  last_sequence_ = f.sequence;
  out = {.data = f.data,
         .bytes = static_cast<std::size_t>(f.stride_bytes) * f.height,
         .width = f.width,
         .height = f.height,
         .stride_bytes = f.stride_bytes,
         .format = f.format,
         .captured = due,
         .arrived = due,
         .device_stamp_ns = f.captured.time_since_epoch().count(),
         .sequence = lap_ * per_lap + f.sequence};
  ++next_;
  ++health_.delivered;
  return ReadStatus::ok;
}

DeviceHealth ReplayFrameSource::health() const {
  return health_.read();
}

}  // namespace sonoband
