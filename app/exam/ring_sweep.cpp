#include "app/exam/ring_sweep.h"

namespace sonoband::exam {
namespace {

// The first picture's pose lies between readings that came before it was captured; the last one's came soon
// after the release.
constexpr Duration before_first = std::chrono::milliseconds(100);
constexpr Duration after_last = std::chrono::milliseconds(20);

}  // namespace

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
  if (f.pose_status == PoseStatus::ok) f.tracker_from_probe = from.tracker_from_probe;
  f.captured = from.tracked.captured;
  f.stamped = from.raw.stamped;
  f.arrived = from.raw.arrived;
  f.device_ns = from.raw.device_stamp_ns;
  f.device_count = from.raw.device_sequence;
  return f;
}

void RingSweep::find_first_reading() {
  const Stamp first = sweep_.pre_roll().empty() ? sweep_.pressed() : sweep_.pre_roll()[0].tracked.captured;
  next_reading_ = readings_->written();
  while (next_reading_ > 0) {
    const std::optional<PoseSample> reading = readings_->read(next_reading_ - 1);
    if (!reading || reading->arrived < first - before_first) break;
    --next_reading_;
  }
  begun_ = true;
}

std::size_t RingSweep::take_poses(std::span<PoseSample> out) {
  if (readings_ == nullptr) return 0;
  if (!begun_) find_first_reading();
  const std::optional<Stamp> released = sweep_.released();
  std::size_t count = 0;
  for (std::uint64_t end = readings_->written(); next_reading_ < end && count < out.size();) {
    const std::optional<PoseSample> reading = readings_->read(next_reading_);
    if (!reading) {
      // A quarter of the log ahead, or the writer would catch up again at once.
      end = readings_->written();
      const std::uint64_t oldest = end - readings_->capacity() / 4 * 3;
      overwritten_ += oldest - next_reading_;
      next_reading_ = oldest;
      continue;
    }
    if (released && reading->arrived > *released + after_last) break;
    out[count++] = *reading;
    ++next_reading_;
  }
  return count;
}

std::vector<Counter> RingSweep::ledger() const {
  std::vector<Counter> counters;
  const LossLedger* ledger = sweep_.ledger();
  if (ledger == nullptr) return counters;
  for (const LedgerLine& line : lines(*ledger)) counters.push_back({line.name, line.value});
  if (overwritten_ > 0) counters.push_back({"readings_overwritten", overwritten_});
  return counters;
}

}  // namespace sonoband::exam
