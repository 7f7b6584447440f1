// Which record of a station follows which, by the device's frame count and its millisecond stamp.
//
// | step of the count     | means                                                        |
// |-----------------------|--------------------------------------------------------------|
// | 1                     | in order                                                     |
// | 0, the same pose      | a duplicate: dropped                                         |
// | 0, another pose       | the count stood still: a new epoch                           |
// | 2..1000               | that many less one were lost                                 |
// | more, or backwards    | the device restarted: a new epoch, if confirmed              |
// | any, against the clock | damaged, or a counter jumped: a new epoch, if confirmed     |
//
// There is no checksum, so one odd record proves nothing: it is held back, and only a second one that agrees
// with it opens the new epoch. If the old count goes on instead, the odd record was damage.
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"

namespace sonoband {

class FrameCounter {
 public:
  enum class Step : std::uint8_t {
    in_order,   // take it; `lost` records are missing before it
    duplicate,  // drop it
    doubtful,   // drop it, unless the next one confirms it
    new_epoch,  // take it as the first of a new epoch
  };
  struct Verdict {
    Step step = Step::in_order;
    std::uint32_t lost = 0;
  };

  explicit FrameCounter(Duration period = from_seconds(1.0 / 240)) : period_(period) {}

  // `same_pose`: the record's pose is, to the bit, that of the record before.
  // Without `time_ms` the count alone decides.
  Verdict judge(std::uint32_t frame, std::optional<std::uint32_t> time_ms, bool same_pose);

 private:
  struct Count {
    std::uint32_t frame = 0;
    std::optional<std::uint32_t> time_ms;
  };
  bool follows(const Count& before, const Count& after) const;

  Duration period_;
  std::optional<Count> last_;
  std::optional<Count> doubtful_;
};

}  // namespace sonoband
