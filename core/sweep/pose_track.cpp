#include "core/sweep/pose_track.h"

#include <algorithm>
#include <cassert>

namespace sonoband {
namespace {

PoseAt interpolate(const PoseSample& before, const PoseSample& after, Stamp t) {
  const double fraction = seconds(t - before.time) / seconds(after.time - before.time);
  const Eigen::Quaterniond q0(before.tracker_from_probe.rotation);
  const Eigen::Quaterniond q1(after.tracker_from_probe.rotation);
  const Eigen::Vector3d position = (1 - fraction) * before.tracker_from_probe.translation +
                                   fraction * after.tracker_from_probe.translation;
  // q and -q are one rotation, and from matrices the sign flips where the turn passes 180 degrees. Eigen's
  // slerp takes the shorter arc whatever the signs.
  return {PoseStatus::ok, std::max(before.quality, after.quality),
          rigid<frame::Tracker, frame::Probe>(q0.normalized().slerp(fraction, q1.normalized()), position)};
}

PoseAt of_one(const PoseSample& s) {
  if (!usable(s.quality)) return {PoseStatus::poor, s.quality, {}};
  return {PoseStatus::ok, s.quality, s.tracker_from_probe};
}

Duration apart(Stamp a, Stamp b) {
  return a < b ? b - a : a - b;
}

}  // namespace

PoseTrack::PoseTrack(std::size_t capacity, const PoseLimits& limits) : limits_(limits), readings_(capacity) {
  assert(capacity >= 2);
}

const PoseSample& PoseTrack::at(std::size_t i) const {
  assert(i < size_);
  return readings_[(first_ + i) % readings_.size()];
}

bool PoseTrack::add(const PoseSample& sample) {
  if (size_ > 0 && newest().epoch == sample.epoch && sample.time <= newest().time) return false;
  // Only readings of older epochs can still be in the way here.
  while (size_ > 0 && newest().time >= sample.time) --size_;
  if (size_ == readings_.size()) {
    first_ = (first_ + 1) % readings_.size();
    --size_;
  }
  PoseSample& kept = readings_[(first_ + size_) % readings_.size()];
  kept = sample;
  const bool finite =
      kept.tracker_from_probe.rotation.allFinite() && kept.tracker_from_probe.translation.allFinite();
  if (usable(kept.quality) && !finite) kept.quality = PoseQuality::fault;
  ++size_;
  return true;
}

PoseAt PoseTrack::pose_at(Stamp t) const {
  if (size_ == 0 || newest().time + limits_.same_time < t) return {};
  // First reading not before t.
  std::size_t low = 0;
  std::size_t high = size_;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (at(middle).time < t)
      low = middle + 1;
    else
      high = middle;
  }
  const bool has_after = low < size_;
  const bool has_before = low > 0;
  const Duration to_after = has_after ? at(low).time - t : Duration::max();
  const Duration to_before = has_before ? apart(at(low - 1).time, t) : Duration::max();
  if (std::min(to_after, to_before) <= limits_.same_time)
    return of_one(to_after <= to_before ? at(low) : at(low - 1));
  if (!has_before) return {PoseStatus::gap, PoseQuality::missing, {}};
  const PoseSample& before = at(low - 1);
  const PoseSample& after = at(low);
  if (before.epoch != after.epoch) return {PoseStatus::new_epoch, PoseQuality::missing, {}};
  if (after.time - before.time > limits_.gap) return {PoseStatus::gap, PoseQuality::missing, {}};
  if (!usable(before.quality) || !usable(after.quality))
    return {PoseStatus::poor, std::max(before.quality, after.quality), {}};
  return interpolate(before, after, t);
}

}  // namespace sonoband
