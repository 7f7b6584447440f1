// One reading of the position tracker.
#pragma once

#include <cstdint>

#include "core/geometry/transforms.h"
#include "core/time.h"

namespace sonoband {

enum class PoseQuality : std::uint8_t {
  good,
  degraded,   // usable, with a warning (some distortion, self-test error)
  distorted,  // metal near by: do not use
  outside,    // outside the mapped or plausible volume
  fault,      // the source or a sensor failed
  missing,    // the station sent nothing when it should have
};

constexpr bool usable(PoseQuality q) {
  return q == PoseQuality::good || q == PoseQuality::degraded;
}

// `tracker_from_probe` means something only while the quality is usable.
struct PoseSample {
  Stamp time{};  // host clock, jitter removed in hal; before the latency offset
  Rigid<frame::Tracker, frame::Probe> tracker_from_probe;
  PoseQuality quality = PoseQuality::missing;
  std::uint32_t epoch = 0;         // changes whenever the tracker was restarted; never bridge poses across it
  std::uint32_t device_frame = 0;  // the device's own counter, raw; 0 where it has none
  std::uint32_t device_ms = 0;     // the device's own time stamp, raw
  Stamp arrived{};                 // when the bytes reached the host
};

}  // namespace sonoband
