#include "hal/tracker/frame_counter.h"

#include <cmath>

namespace sonoband {

// Both counts wrap at 2^32 (the clock after 49.7 days); differences modulo 2^32 do not notice.
bool FrameCounter::follows(const Count& before, const Count& after) const {
  constexpr std::uint32_t most_lost = 1000;  // 4 s at 240 Hz: longer is a restart for all we can tell
  constexpr double tolerance_ms = 2;         // two roundings to 1 ms and the device's own lateness
  const std::uint32_t frames = after.frame - before.frame;
  if (frames == 0 || frames > most_lost) return false;
  const double expected_ms = 1000 * seconds(period_) * frames;
  if (!before.time_ms || !after.time_ms) return true;
  const double elapsed_ms = static_cast<std::int32_t>(*after.time_ms - *before.time_ms);
  return std::abs(elapsed_ms - expected_ms) <= tolerance_ms;
}

FrameCounter::Verdict FrameCounter::judge(std::uint32_t frame, std::optional<std::uint32_t> time_ms,
                                          bool same_pose) {
  const Count now{frame, time_ms};
  if (!last_) {
    last_ = now;
    return {Step::in_order, 0};
  }
  if (follows(*last_, now)) {
    const std::uint32_t lost = frame - last_->frame - 1;
    last_ = now;
    doubtful_.reset();
    return {Step::in_order, lost};
  }
  if (frame == last_->frame && same_pose) return {Step::duplicate, 0};
  if (frame == last_->frame || (doubtful_ && follows(*doubtful_, now))) {
    last_ = now;
    doubtful_.reset();
    return {Step::new_epoch, 0};
  }
  doubtful_ = now;
  return {Step::doubtful, 0};
}

}  // namespace sonoband
