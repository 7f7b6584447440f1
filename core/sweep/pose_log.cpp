#include "core/sweep/pose_log.h"

#include <bit>

namespace sonoband {
namespace {

using Words = std::array<std::uint64_t, 16>;

std::uint64_t bits(Stamp t) {
  return static_cast<std::uint64_t>(t.time_since_epoch().count());
}
Stamp stamp(std::uint64_t bits) {
  return Stamp(Duration(static_cast<std::int64_t>(bits)));
}

Words pack(const PoseSample& s) {
  Words w{};
  for (std::size_t i = 0; i < 9; ++i)
    w[i] = std::bit_cast<std::uint64_t>(s.tracker_from_probe.rotation.data()[i]);
  for (std::size_t i = 0; i < 3; ++i)
    w[9 + i] = std::bit_cast<std::uint64_t>(s.tracker_from_probe.translation.data()[i]);
  w[12] = bits(s.time);
  w[13] = bits(s.arrived);
  w[14] = std::uint64_t{s.epoch} << 32 | s.device_frame;
  w[15] = std::uint64_t{s.device_ms} << 32 | static_cast<std::uint64_t>(s.quality);
  return w;
}

PoseSample unpack(const Words& w) {
  PoseSample s;
  for (std::size_t i = 0; i < 9; ++i) s.tracker_from_probe.rotation.data()[i] = std::bit_cast<double>(w[i]);
  for (std::size_t i = 0; i < 3; ++i)
    s.tracker_from_probe.translation.data()[i] = std::bit_cast<double>(w[9 + i]);
  s.time = stamp(w[12]);
  s.arrived = stamp(w[13]);
  s.epoch = static_cast<std::uint32_t>(w[14] >> 32);
  s.device_frame = static_cast<std::uint32_t>(w[14]);
  s.device_ms = static_cast<std::uint32_t>(w[15] >> 32);
  s.quality = static_cast<PoseQuality>(w[15] & 0xff);
  return s;
}

}  // namespace

PoseLog::PoseLog(std::size_t capacity)
    : mask_(std::bit_ceil(capacity) - 1), cells_(std::make_unique<Cell[]>(mask_ + 1)) {}

void PoseLog::add(const PoseSample& sample) {
  const std::uint64_t number = written_.load(std::memory_order_relaxed);
  Cell& cell = cells_[number & mask_];
  const Words words = pack(sample);
  cell.holds.store(0, std::memory_order_relaxed);
  // Each release orders it after the line above.
  for (std::size_t i = 0; i < words.size(); ++i) cell.words[i].store(words[i], std::memory_order_release);
  cell.holds.store(number + 1, std::memory_order_release);
  written_.store(number + 1, std::memory_order_release);
}

std::optional<PoseSample> PoseLog::read(std::uint64_t number) const {
  const Cell& cell = cells_[number & mask_];
  if (cell.holds.load(std::memory_order_acquire) != number + 1) return std::nullopt;
  Words words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = cell.words[i].load(std::memory_order_acquire);
  if (cell.holds.load(std::memory_order_relaxed) != number + 1) return std::nullopt;
  return unpack(words);
}

}  // namespace sonoband
