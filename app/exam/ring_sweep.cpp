#include "app/exam/ring_sweep.h"

namespace sonoband::exam {

std::int64_t RingSweep::published() const {
  return static_cast<std::int64_t>(sweep_.pre_roll().size() + sweep_.swept().size());
}

FrameRecord RingSweep::frame(std::int64_t number) const {
  // The sweep's frames lie in one piece of memory that never changes; a release that becomes known between
  // published() and here only makes `swept` shorter.
  const std::span<const SweepFrame> before = sweep_.pre_roll();
  const SweepFrame& from = sweep_.swept().data()[number - static_cast<std::int64_t>(before.size())];
  const bool pre_roll = number < static_cast<std::int64_t>(before.size());
  FrameRecord f;
  f.pixels = from.tracked.bscan.pixels;
  f.kind = from.tracked.bscan.kind;
  f.number = number;
  f.pre_roll = pre_roll;
  f.pose_status = from.tracked.pose_status;
  f.world_from_image = from.tracked.world_from_image;
  f.captured = from.tracked.captured;
  f.stamped = from.raw.stamped;
  f.arrived = from.raw.arrived;
  f.device_ns = from.raw.device_stamp_ns;
  f.device_count = from.raw.device_sequence;
  return f;
}

std::size_t RingSweep::take_poses(std::span<PoseSample> out) {
  std::size_t count = 0;
  if (readings_ == nullptr) return 0;
  for (const PoseSample* p = readings_->front(); p != nullptr && count < out.size(); p = readings_->front()) {
    out[count++] = *p;
    readings_->pop();
  }
  return count;
}

std::vector<Counter> RingSweep::ledger() const {
  std::vector<Counter> counters;
  const LossLedger* ledger = sweep_.ledger();
  if (ledger == nullptr) return counters;
  for (const LedgerLine& line : lines(*ledger)) counters.push_back({line.name, line.value});
  return counters;
}

}  // namespace sonoband::exam
