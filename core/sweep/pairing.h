// Frames wait here, in order, for the pose after them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/sweep/pose_track.h"

namespace sonoband {

struct PairingSettings {
  // Latency of the scanner and grabber minus latency of the tracker, from temporal calibration; it may be
  // negative. Usual: 50 to 300 ms minus 4 to 20 ms. An error of 10 ms at 50 mm/s misplaces a frame by 0.5 mm.
  Duration latency_offset{};
  // A frame that waited so long since it reached the host goes on without a pose. Usual: 100 ms.
  Duration wait = std::chrono::milliseconds(100);
  // Frames that may wait at once; one more pushes the oldest out without a pose. 16 cover the usual wait at
  // 60 frames a second twice.
  std::size_t capacity = 16;
};

struct WaitingFrame {
  std::uint32_t ticket = 0;  // the caller's own, usually a ring slot
  Stamp stamped{};           // Frame::captured, before the latency offset
  Stamp arrived{};           // when the waiting began
};

struct PairedFrame {
  std::uint32_t ticket = 0;
  Stamp captured{};  // after the latency offset: on the tracker's time
  PoseAt pose;       // or the reason why there is none
};

// One thread. Allocates only when made.
class Pairing {
 public:
  explicit Pairing(const PairingSettings& settings);

  // THE place where the latency offset is applied. A picture on the scanner's output at `stamped` shows the
  // body as it was one scanner latency earlier, so its pose is looked for earlier: minus.
  Stamp captured(Stamp stamped) const { return stamped - settings_.latency_offset; }

  // Frames come in order of their stamps. False, and not taken, when full: pop first.
  [[nodiscard]] bool push(const WaitingFrame& frame);

  // The oldest waiting frame once its pose is known, or known not to be had, or its wait is over, or the
  // queue is full. Call until it gives nothing.
  std::optional<PairedFrame> pop(const PoseTrack& track, Stamp now);

  // The oldest waiting frame at once, with what is known: for the end of acquisition.
  std::optional<PairedFrame> pop_now(const PoseTrack& track);

  std::size_t waiting() const { return size_; }

 private:
  PairingSettings settings_;
  std::vector<WaitingFrame> frames_;  // circular
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sonoband
