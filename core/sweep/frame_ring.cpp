#include "core/sweep/frame_ring.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <type_traits>

namespace sonoband {
namespace {

constexpr std::size_t line = 64;  // bytes of a cache line; also the widest vector register
constexpr std::uint64_t slot_bits = 24;
constexpr std::uint64_t slot_mask = (std::uint64_t{1} << slot_bits) - 1;
constexpr std::int64_t still_growing = std::numeric_limits<std::int64_t>::max();

std::size_t round_up(std::size_t bytes) {
  return (bytes + line - 1) / line * line;
}

// Hands out pieces of one block; without a block it only adds up their sizes.
class Carver {
 public:
  explicit Carver(std::byte* base) : base_(base) {}

  template <class T>
  T* take(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= line);
    std::byte* at = base_ == nullptr ? nullptr : base_ + used_;
    used_ += round_up(count * sizeof(T));  // NOLINT(bugprone-sizeof-expression): T is a pointer for the index
    if (at == nullptr) return nullptr;
    T* first = reinterpret_cast<T*>(at);
    for (std::size_t i = 0; i < count; ++i) ::new (static_cast<void*>(first + i)) T();
    return std::launder(first);
  }
  std::size_t used() const { return used_; }

 private:
  std::byte* base_;
  std::size_t used_ = 0;
};

}  // namespace

FrameRing::FrameRing(const RingSettings& settings, MaskView mask) : settings_(settings) {
  assert(settings.width > 0 && settings.height > 0 && settings.sweeps > 0);
  assert(settings.reserve >= 2 && settings.slots > settings.reserve && settings.slots <= slot_mask);
  assert(settings.sweeps < sweep_bits && settings.leases < 0x7fff);
  assert(mask.empty() || (mask.width == settings.width && mask.height == settings.height));
  lay_out(nullptr);
  memory_.reset(static_cast<std::byte*>(::operator new (bytes_, std::align_val_t{line})));
  // Every page is touched here, so that the first sweep meets no page faults.
  std::memset(memory_.get(), 0, bytes_);
  lay_out(memory_.get());
  if (!mask.empty()) {
    for (int y = 0; y < mask.height; ++y)
      std::copy_n(mask.row(y), mask.width, mask_pixels_ + static_cast<std::ptrdiff_t>(y) * mask.width);
    mask_ = {mask_pixels_, mask.width, mask.height, mask.width};
  }
}

FrameRing::~FrameRing() {
  assert(leases_.load() == 0);
  for (std::uint32_t i = 0; i < settings_.sweeps; ++i) {
    // A growing sweep that nobody else holds ends with its ring.
    assert(!records_[i].in_use.load() || (&records_[i] == growing_ && records_[i].holds.load() == 1));
  }
}

void FrameRing::lay_out(std::byte* base) {
  const std::size_t n = settings_.slots;
  const std::size_t stride = round_up(static_cast<std::size_t>(settings_.width));
  const std::size_t slot_bytes = stride * static_cast<std::size_t>(settings_.height) + line;
  Carver carver(base);
  holds_ = carver.take<std::atomic<std::uint32_t>>(n);
  numbers_ = carver.take<std::uint64_t>(n);
  order_ = carver.take<std::uint32_t>(n);
  slots_ = carver.take<RingSlot>(n);
  records_ = carver.take<detail::SweepRecord>(settings_.sweeps);
  for (std::uint32_t i = 0; i < settings_.sweeps; ++i) {
    detail::SweepRecord sized;
    detail::SweepRecord& record = base == nullptr ? sized : records_[i];
    record.ring = this;
    record.frames = carver.take<SweepFrame>(n);
    record.posed = carver.take<const TrackedFrame*>(n);
    record.posed_before = carver.take<std::uint32_t>(n);
    record.slots = carver.take<std::uint32_t>(n);
  }
  mask_pixels_ = carver.take<std::uint8_t>(static_cast<std::size_t>(settings_.width) * settings_.height);
  pixels_ = carver.take<std::uint8_t>(n * slot_bytes);
  bytes_ = carver.used();
  if (base == nullptr) return;
  for (std::uint32_t i = 0; i < n; ++i) {
    RingSlot& s = slots_[i];
    s.index = i;
    s.pixels = {pixels_ + i * slot_bytes, settings_.width, settings_.height,
                static_cast<std::ptrdiff_t>(stride)};
    s.frame.tracked.bscan = {s.pixels, settings_.kind};
  }
}

RingSlot* FrameRing::claim() {
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed) >> slot_bits;
  for (;;) {
    // A walk over all slots: some microseconds for thousands, against the 300 kB of a picture, and no list
    // that releases on other threads would have to keep.
    std::uint32_t oldest = settings_.slots;
    for (std::uint32_t i = 0; i < settings_.slots; ++i) {
      if (holds_[i].load(std::memory_order_relaxed) != 0) continue;
      if (numbers_[i] == newest && newest != 0) continue;
      if (oldest == settings_.slots || numbers_[i] < numbers_[oldest]) oldest = i;
    }
    if (oldest == settings_.slots) return nullptr;
    std::uint32_t nobody = 0;
    // Acquire: what the last reader read of this slot is over before it is overwritten. It fails only when a
    // lease was taken in between; leases are few, so this ends.
    if (holds_[oldest].compare_exchange_strong(nobody, writing, std::memory_order_acquire)) {
      numbers_[oldest] = 0;
      RingSlot& claimed = slots_[oldest];
      claimed.frame = {};
      claimed.frame.tracked.bscan = {claimed.pixels, settings_.kind};
      return &claimed;
    }
  }
}

void FrameRing::discard(RingSlot& claimed) {
  assert((holds_[claimed.index].load() & writing) != 0);
  holds_[claimed.index].fetch_and(~writing, std::memory_order_release);
}

Published FrameRing::publish(RingSlot& claimed) {
  const std::uint32_t i = claimed.index;
  assert((holds_[i].load() & writing) != 0);
  assert(claimed.frame.tracked.captured >= last_captured_);
  last_captured_ = claimed.frame.tracked.captured;
  const std::uint64_t number = (newest_.load(std::memory_order_relaxed) >> slot_bits) + 1;
  numbers_[i] = number;
  order_[number % settings_.slots] = i;
  Published outcome = Published::live;
  if (growing_ != nullptr) {
    if (!growing_full_) growing_full_ = !append(i);
    outcome = growing_full_ ? Published::ring_full : Published::in_sweep;
  }
  holds_[i].fetch_and(~writing, std::memory_order_release);
  newest_.store(number << slot_bits | i, std::memory_order_release);
  return outcome;
}

std::uint32_t FrameRing::room() const {
  const std::uint32_t most = settings_.slots - settings_.reserve;
  const std::uint32_t held = held_.load(std::memory_order_relaxed);
  return held < most ? most - held : 0;
}

bool FrameRing::append(std::uint32_t slot) {
  detail::SweepRecord& record = *growing_;
  const std::uint32_t n = record.count.load(std::memory_order_relaxed);
  if (n == settings_.slots) return false;
  // A slot that another sweep holds costs no room. The counts err towards "held" while another thread is
  // dropping a sweep, never towards "free".
  if ((holds_[slot].fetch_add(one_sweep, std::memory_order_relaxed) & sweep_bits) == 0) {
    if (room() == 0) {
      holds_[slot].fetch_sub(one_sweep, std::memory_order_relaxed);
      return false;
    }
    held_.fetch_add(1, std::memory_order_relaxed);
  }
  SweepFrame& frame = record.frames[n];
  frame = slots_[slot].frame;
  frame.tracked.sweep_id = record.id;
  frame.tracked.sequence = n;
  record.slots[n] = slot;
  const std::uint32_t posed =
      n == 0
          ? 0
          : record.posed_before[n - 1] + (record.frames[n - 1].tracked.pose_status == PoseStatus::ok ? 1 : 0);
  record.posed_before[n] = posed;
  if (frame.tracked.pose_status == PoseStatus::ok) record.posed[posed] = &frame.tracked;
  record.count.store(n + 1, std::memory_order_release);
  return true;
}

Sweep FrameRing::begin_sweep(std::int32_t id, Stamp pressed, Duration pre_roll) {
  assert(growing_ == nullptr);
  detail::SweepRecord* const end = records_ + settings_.sweeps;
  // Acquire: whoever dropped this record is through with it.
  detail::SweepRecord* record =
      std::find_if(records_, end, [](const auto& r) { return !r.in_use.load(std::memory_order_acquire); });
  if (record == end || room() == 0) return {};

  // Back from the newest frame to the first swept one, then on into the pre-roll.
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed) >> slot_bits;
  const auto published = [&](std::uint64_t number) {
    const std::uint32_t i = order_[number % settings_.slots];
    return number > 0 && numbers_[i] == number ? &slots_[i] : nullptr;
  };
  std::uint64_t first = newest + 1;  // the oldest frame to take, so far
  std::uint32_t taken = 0;
  while (first > 1 && published(first - 1) != nullptr &&
         published(first - 1)->frame.tracked.captured >= pressed) {
    --first;
    ++taken;
  }
  const bool start_complete = first <= 1 || published(first - 1) != nullptr;
  const std::uint32_t left = room() > taken ? room() - taken : 0;
  for (std::uint32_t most = left / 2; most > 0 && first > 1; --most, --first) {
    const RingSlot* before = published(first - 1);
    if (before == nullptr || before->frame.tracked.captured < pressed - pre_roll) break;
  }

  record->id = id;
  record->pressed = pressed;
  record->start_complete = start_complete;
  record->released_ns.store(still_growing, std::memory_order_relaxed);
  record->count.store(0, std::memory_order_relaxed);
  record->holds.store(2, std::memory_order_relaxed);  // the writer's and the one returned
  record->in_use.store(true, std::memory_order_relaxed);
  growing_ = record;
  growing_full_ = false;
  for (std::uint64_t number = first; number <= newest && !growing_full_; ++number)
    growing_full_ = !append(order_[number % settings_.slots]);
  return Sweep(record);
}

void FrameRing::end_sweep(Stamp released, const LossLedger& ledger) {
  assert(growing_ != nullptr);
  detail::SweepRecord& record = *growing_;
  growing_ = nullptr;
  record.ledger = ledger;
  record.released_ns.store(released.time_since_epoch().count(), std::memory_order_release);
  drop(record);
}

void FrameRing::drop(detail::SweepRecord& record) {
  if (record.holds.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  const std::uint32_t count = record.count.load(std::memory_order_relaxed);
  for (std::uint32_t n = 0; n < count; ++n) {
    // Release: the pixels have been read before the writer may take the slot.
    if ((holds_[record.slots[n]].fetch_sub(one_sweep, std::memory_order_release) & sweep_bits) == one_sweep)
      held_.fetch_sub(1, std::memory_order_relaxed);
  }
  record.in_use.store(false, std::memory_order_release);
}

FrameLease FrameRing::latest() const {
  if (leases_.fetch_add(1, std::memory_order_relaxed) >= settings_.leases) {
    leases_.fetch_sub(1, std::memory_order_relaxed);
    leases_refused_.fetch_add(1, std::memory_order_relaxed);
    return {};
  }
  // Repeats only when the writer has gone once round all free slots since newest_ was read.
  for (;;) {
    const std::uint64_t newest = newest_.load(std::memory_order_acquire);
    if (newest == 0) break;
    const auto i = static_cast<std::uint32_t>(newest & slot_mask);
    std::uint32_t holds = holds_[i].load(std::memory_order_relaxed);
    bool leased = false;
    while (!leased && (holds & writing) == 0)
      leased = holds_[i].compare_exchange_weak(holds, holds + one_lease, std::memory_order_acquire,
                                               std::memory_order_relaxed);
    if (!leased) continue;
    if (numbers_[i] == newest >> slot_bits) return {this, i};
    holds_[i].fetch_sub(one_lease, std::memory_order_release);
  }
  leases_.fetch_sub(1, std::memory_order_relaxed);
  return {};
}

void FrameRing::end_lease(std::uint32_t slot) const {
  holds_[slot].fetch_sub(one_lease, std::memory_order_release);
  leases_.fetch_sub(1, std::memory_order_relaxed);
}

RingStatus FrameRing::status() const {
  RingStatus s;
  s.room = room();
  s.held = held_.load(std::memory_order_relaxed);
  for (std::uint32_t i = 0; i < settings_.sweeps; ++i)
    s.sweeps += records_[i].in_use.load(std::memory_order_relaxed) ? 1 : 0;
  s.published = newest_.load(std::memory_order_relaxed) >> slot_bits;
  s.leases_refused = leases_refused_.load(std::memory_order_relaxed);
  return s;
}

}  // namespace sonoband
