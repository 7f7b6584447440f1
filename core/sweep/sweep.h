// What readers hold of a frame ring: a whole sweep, or the newest frame for a moment.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/sweep/loss_ledger.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband {

class FrameRing;

// The stamps of a frame as they came, before anything was made of them.
struct RawStamps {
  Stamp stamped{};  // Frame::captured, before the latency offset
  Stamp arrived{};
  std::int64_t device_stamp_ns = 0;
  std::uint64_t device_sequence = 0;
};

struct SweepFrame {
  TrackedFrame tracked;
  RawStamps raw;
  Rigid<frame::Tracker, frame::Probe> tracker_from_probe;  // as paired; only with pose_status ok
};

namespace detail {

// One sweep's memory inside the ring. The writer fills `frames` from the front and then stores `count`; what
// lies below `count` never changes until the last hold is gone.
struct SweepRecord {
  FrameRing* ring = nullptr;
  std::atomic<bool> in_use{false};
  std::atomic<std::uint32_t> holds{0};  // Sweep objects, and the writer while the sweep grows
  std::int32_t id = 0;
  Stamp pressed{};
  bool start_complete = true;
  LossLedger ledger;                        // written before `released` is
  std::atomic<std::int64_t> released_ns{};  // growing: the greatest value
  std::atomic<std::uint32_t> count{0};
  SweepFrame* frames = nullptr;
  const TrackedFrame** posed = nullptr;   // those of `frames` that have a pose, in order
  std::uint32_t* posed_before = nullptr;  // per frame: how many of the frames before it have a pose
  std::uint32_t* slots = nullptr;         // per frame: the slot it holds
};

}  // namespace detail

// A read-only hold on the frames of a press: from its pre-roll to its release, growing until then. Its slots
// are not overwritten while any copy of the Sweep lives. What it hands out is valid as long.
//
// Thread rule: any thread may copy, read or drop its own Sweep object at any time, also while the sweep
// grows; nothing blocks and nothing allocates. All Sweeps must be gone before their ring.
class Sweep {
 public:
  Sweep() = default;  // holds nothing; only `operator bool` and assignment make sense
  Sweep(const Sweep& other);
  Sweep(Sweep&& other) noexcept : record_(other.record_) { other.record_ = nullptr; }
  Sweep& operator=(Sweep other) noexcept;
  ~Sweep();

  explicit operator bool() const { return record_ != nullptr; }
  std::int32_t id() const { return record_->id; }
  Stamp pressed() const { return record_->pressed; }
  std::optional<Stamp> released() const;  // empty while it grows
  // False: the press was known so late that the ring had overwritten frames taken after it.
  bool start_complete() const { return record_->start_complete; }
  // Of the frames from press to release. Null while the sweep grows.
  const LossLedger* ledger() const;

  // In order of capture, with a pose or without. `captured` of a frame decides where it belongs: before the
  // press it is pre-roll; from the press to the release, both included, it was swept. Frames taken after the
  // release but stored before the release was known are held and shown by neither.
  std::span<const SweepFrame> pre_roll() const;
  std::span<const SweepFrame> swept() const;
  // The swept frames that have a pose: the input of rendering. A growing sweep gives more the next time.
  SweepView view() const;

 private:
  friend class FrameRing;
  // Takes over one hold that is counted already.
  explicit Sweep(detail::SweepRecord* record) : record_(record) {}

  struct Extent {
    std::uint32_t first = 0;  // swept frames are [first, last)
    std::uint32_t last = 0;
  };
  Extent extent() const;

  detail::SweepRecord* record_ = nullptr;
};

// The newest published frame, safe from being overwritten while this object lives. Keep it for one drawing,
// not longer: few can be out at once (RingSettings::leases). Not for sharing between threads.
class FrameLease {
 public:
  FrameLease() = default;
  FrameLease(FrameLease&& other) noexcept;
  FrameLease& operator=(FrameLease&& other) noexcept;
  ~FrameLease();

  explicit operator bool() const { return ring_ != nullptr; }
  const SweepFrame& frame() const;

 private:
  friend class FrameRing;
  FrameLease(const FrameRing* ring, std::uint32_t slot) : ring_(ring), slot_(slot) {}

  const FrameRing* ring_ = nullptr;
  std::uint32_t slot_ = 0;
};

}  // namespace sonoband
