// The last readings of the tracker, and where the probe was at a given time, or why that is not known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sweep/pose_sample.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband {

struct PoseLimits {
  // Two readings farther apart than this are not bridged. Usual: 50 ms, 12 periods of a 240 Hz tracker; a
  // freehand sweep of 50 mm/s moves 2.5 mm meanwhile.
  Duration gap = std::chrono::milliseconds(50);
  // Times closer than this are the same time (PLUS takes 1e-5 s), so a frame stamped with a reading's own
  // time does not wait for the next one.
  Duration same_time = std::chrono::microseconds(10);
};

// `tracker_from_probe` means something only with status ok.
struct PoseAt {
  PoseStatus status = PoseStatus::not_yet;
  PoseQuality quality = PoseQuality::missing;  // the worse of the two readings
  Rigid<frame::Tracker, frame::Probe> tracker_from_probe;
};

// One writer and reader: not for sharing between threads. Allocates only when made.
class PoseTrack {
 public:
  // `capacity` readings are kept, the oldest give way. It must cover the oldest frame still waiting: latency
  // offset + wait, some 0.5 s; 1024 readings are 4 s at 240 Hz.
  explicit PoseTrack(std::size_t capacity, const PoseLimits& limits = {});

  // False: the reading is not kept, because within its epoch it is not later than the one before. A reading
  // of a new epoch is always kept; older-epoch readings not earlier than it are dropped. A usable reading
  // with a non-finite pose is kept as a fault.
  bool add(const PoseSample& sample);

  // Linear position and shortest-arc slerp between the readings around `t`, both usable, of one epoch and no
  // farther apart than the gap limit. Never extrapolates: `not_yet` after the newest reading, `gap` before
  // the oldest one kept.
  PoseAt pose_at(Stamp t) const;

  std::size_t size() const { return size_; }
  const PoseSample& newest() const { return at(size_ - 1); }  // asserts that there is one

 private:
  const PoseSample& at(std::size_t i) const;  // 0 is the oldest

  PoseLimits limits_;
  std::vector<PoseSample> readings_;  // circular
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sonoband
