// Fixed memory for the newest B-scans and for the sweeps held among them. README.md has the drawing.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>

#include "core/sweep/sweep.h"

namespace sonoband {

struct RingSettings {
  int width = 640;  // of one cropped picture
  int height = 480;
  PixelKind kind = PixelKind::grey;
  // Pictures there is room for. 640 x 480 at 30 frames a second: 1800 are a minute and 0.55 GB.
  std::uint32_t slots = 1800;
  // Of these, the slots that sweeps may never take, so that the live view and the pre-roll go on when the
  // sweeps hold all the rest. At least the frames that wait for their pose + leases + 2; more means a
  // pre-roll even then. Usual: 32.
  std::uint32_t reserve = 32;
  std::uint32_t sweeps = 8;  // that may be held at once
  std::uint32_t leases = 4;  // newest-frame leases that may be out at once, one for each reader
};

// A slot while the writer fills it. The pixels are as wide and high as set; rows start on 64-byte boundaries
// and 64 bytes behind the last row may be read.
struct RingSlot {
  SweepFrame frame;  // bscan is set; the writer fills the rest
  ImageView<std::uint8_t> pixels;
  std::uint32_t index = 0;  // of the slot, as in slot(index)
};

enum class Published : std::uint8_t {
  live,       // no sweep grows
  in_sweep,   // and appended to the growing one
  ring_full,  // shown live only: the growing sweep has no room, now or later
};

struct RingStatus {
  std::uint32_t room = 0;       // frames that sweeps can still take
  std::uint32_t held = 0;       // slots held by sweeps
  std::uint32_t sweeps = 0;     // held or growing
  std::uint64_t published = 0;  // since start
  std::uint64_t leases_refused = 0;
};

// Thread rule: one thread is the writer (claim, publish, discard, begin_sweep, end_sweep). latest, status and
// all that Sweep offers are for any thread. The writer never waits for a reader, allocates nothing and takes
// no lock: one allocation is made by the constructor, nothing after. A reader sees published frames only.
class FrameRing {
 public:
  // The mask (of the pictures' size, or empty) is copied. Throws std::bad_alloc.
  explicit FrameRing(const RingSettings& settings, MaskView mask = {});
  ~FrameRing();  // asserts that no Sweep and no lease is left
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;

  const RingSettings& settings() const { return settings_; }
  MaskView mask() const { return mask_; }
  std::span<const std::byte> memory() const { return {memory_.get(), bytes_}; }  // to be locked by the caller

  // The slot of the oldest published frame that nobody holds, never the newest frame's. Null: none (the
  // reserve is too small). Several may be claimed at once; they are published in the order of `captured`.
  RingSlot* claim();
  RingSlot& slot(std::uint32_t index) { return slots_[index]; }
  void discard(RingSlot& claimed);
  // Makes the frame visible to readers, and appends it to the sweep that grows. Asserts that `captured` is
  // not before that of the frame published last.
  Published publish(RingSlot& claimed);

  // Starts to grow a sweep (asserts that none does) from frames published already: all taken at `pressed` or
  // later, and those at most `pre_roll` before, for which at most half of the room is taken. Empty and
  // nothing held: no room, or as many sweeps are held as there may be.
  Sweep begin_sweep(std::int32_t id, Stamp pressed, Duration pre_roll);
  bool growing() const { return growing_ != nullptr; }
  // Frames taken after `released` that are in the sweep already no longer count as swept.
  void end_sweep(Stamp released, const LossLedger& ledger);

  // The newest published frame; empty before the first and when too many leases are out.
  FrameLease latest() const;
  RingStatus status() const;

 private:
  friend class Sweep;
  friend class FrameLease;

  void lay_out(std::byte* base);  // null: only sums up bytes_
  bool append(std::uint32_t slot);
  void drop(detail::SweepRecord& record);
  void end_lease(std::uint32_t slot) const;
  const SweepFrame& leased(std::uint32_t slot) const { return slots_[slot].frame; }
  std::uint32_t room() const;

  // Per slot, in `holds_`: the sweeps that hold it, the leases, and whether the writer has it. The writer
  // takes a slot by compare-and-swap from 0, so nobody can hold what it fills.
  static constexpr std::uint32_t one_sweep = 1;
  static constexpr std::uint32_t sweep_bits = 0xffff;
  static constexpr std::uint32_t one_lease = 0x10000;
  static constexpr std::uint32_t writing = 0x80000000;

  struct Free {
    void operator()(std::byte* p) const { ::operator delete (p, std::align_val_t{64}); }
  };

  RingSettings settings_;
  MaskView mask_;
  std::size_t bytes_ = 0;
  std::unique_ptr<std::byte, Free> memory_;

  RingSlot* slots_ = nullptr;
  std::atomic<std::uint32_t>* holds_ = nullptr;
  std::uint64_t* numbers_ = nullptr;  // per slot: the how-manieth published frame it has, from 1; 0: none
  std::uint32_t* order_ = nullptr;    // slot of frame number n at n % slots, while numbers_ agrees
  detail::SweepRecord* records_ = nullptr;
  std::uint8_t* mask_pixels_ = nullptr;
  std::uint8_t* pixels_ = nullptr;

  detail::SweepRecord* growing_ = nullptr;
  bool growing_full_ = false;  // once refused, always refused: a full sweep ends short, it gets no holes
  Stamp last_captured_ = Stamp::min();

  std::atomic<std::uint64_t> newest_{0};  // number of the newest frame * 2^24 + its slot; 0: none
  std::atomic<std::uint32_t> held_{0};
  mutable std::atomic<std::uint32_t> leases_{0};
  mutable std::atomic<std::uint64_t> leases_refused_{0};
};

}  // namespace sonoband
