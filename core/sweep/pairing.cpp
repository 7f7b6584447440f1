#include "core/sweep/pairing.h"

#include <cassert>

namespace sonoband {

Pairing::Pairing(const PairingSettings& settings) : settings_(settings), frames_(settings.capacity) {
  assert(settings.capacity >= 1);
}

bool Pairing::push(const WaitingFrame& frame) {
  if (size_ == frames_.size()) return false;
  frames_[(first_ + size_) % frames_.size()] = frame;
  ++size_;
  return true;
}

std::optional<PairedFrame> Pairing::pop(const PoseTrack& track, Stamp now) {
  if (size_ == 0) return std::nullopt;
  const WaitingFrame& oldest = frames_[first_];
  const bool may_wait = size_ < frames_.size() && now - oldest.arrived < settings_.wait;
  if (may_wait && track.pose_at(captured(oldest.stamped)).status == PoseStatus::not_yet) return std::nullopt;
  return pop_now(track);
}

std::optional<PairedFrame> Pairing::pop_now(const PoseTrack& track) {
  if (size_ == 0) return std::nullopt;
  const WaitingFrame oldest = frames_[first_];
  first_ = (first_ + 1) % frames_.size();
  --size_;
  const Stamp time = captured(oldest.stamped);
  return PairedFrame{oldest.ticket, time, track.pose_at(time)};
}

}  // namespace sonoband
