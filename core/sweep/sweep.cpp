#include "core/sweep/sweep.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/sweep/frame_ring.h"

namespace sonoband {

Sweep::Sweep(const Sweep& other) : record_(other.record_) {
  if (record_ != nullptr) record_->holds.fetch_add(1, std::memory_order_relaxed);
}

Sweep& Sweep::operator=(Sweep other) noexcept {
  std::swap(record_, other.record_);
  return *this;
}

Sweep::~Sweep() {
  if (record_ != nullptr) record_->ring->drop(*record_);
}

std::optional<Stamp> Sweep::released() const {
  const std::int64_t ns = record_->released_ns.load(std::memory_order_acquire);
  if (ns == std::numeric_limits<std::int64_t>::max()) return std::nullopt;
  return Stamp(Duration(ns));
}

const LossLedger* Sweep::ledger() const {
  return released() ? &record_->ledger : nullptr;
}

Sweep::Extent Sweep::extent() const {
  // The release is read before the count: a sweep seen as closed then shows all its frames.
  const Stamp release = released().value_or(Stamp::max());
  const std::span<const SweepFrame> held(record_->frames, record_->count.load(std::memory_order_acquire));
  const auto first = std::partition_point(
      held.begin(), held.end(), [&](const SweepFrame& f) { return f.tracked.captured < record_->pressed; });
  const auto last = std::partition_point(first, held.end(),
                                         [&](const SweepFrame& f) { return f.tracked.captured <= release; });
  return {static_cast<std::uint32_t>(first - held.begin()), static_cast<std::uint32_t>(last - held.begin())};
}

std::span<const SweepFrame> Sweep::pre_roll() const {
  return {record_->frames, extent().first};
}

std::span<const SweepFrame> Sweep::swept() const {
  const Extent e = extent();
  return {record_->frames + e.first, e.last - e.first};
}

SweepView Sweep::view() const {
  const Extent e = extent();
  if (e.first == e.last) return {{}, record_->ring->mask()};
  const SweepFrame& end = record_->frames[e.last - 1];
  const std::uint32_t from = record_->posed_before[e.first];
  const std::uint32_t to =
      record_->posed_before[e.last - 1] + (end.tracked.pose_status == PoseStatus::ok ? 1 : 0);
  return {{record_->posed + from, to - from}, record_->ring->mask()};
}

FrameLease::FrameLease(FrameLease&& other) noexcept : ring_(other.ring_), slot_(other.slot_) {
  other.ring_ = nullptr;
}

FrameLease& FrameLease::operator=(FrameLease&& other) noexcept {
  std::swap(ring_, other.ring_);
  std::swap(slot_, other.slot_);
  return *this;
}

FrameLease::~FrameLease() {
  if (ring_ != nullptr) ring_->end_lease(slot_);
}

const SweepFrame& FrameLease::frame() const {
  return ring_->leased(slot_);
}

}  // namespace sonoband
