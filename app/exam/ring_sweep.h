// A sweep of the frame ring, as the recorder reads it.
#pragma once

#include "app/exam/recorder.h"
#include "core/sweep/pose_log.h"
#include "core/sweep/sweep.h"

namespace sonoband::exam {

// Numbers the frames from the pre-roll to the release. Holds the ring's slots until the recorder lets go.
class RingSweep final : public SweepSource {
 public:
  // `readings`: every reading of the tracker; it must outlive this. Saved are those that arrived from 100 ms
  // before the first picture was captured to 20 ms after the release. Null: none are saved.
  explicit RingSweep(Sweep sweep, const PoseLog* readings = nullptr)
      : sweep_(std::move(sweep)), readings_(readings) {}

  bool finished() const override { return sweep_.released().has_value(); }
  std::int64_t published() const override;
  FrameRecord frame(std::int64_t number) const override;
  std::size_t take_poses(std::span<PoseSample> out) override;
  // Besides the ring's own: readings_overwritten, when the log had forgotten some before they were taken.
  std::vector<Counter> ledger() const override;

 private:
  void find_first_reading();

  Sweep sweep_;
  const PoseLog* readings_;
  bool begun_ = false;
  std::uint64_t next_reading_ = 0;
  std::uint64_t overwritten_ = 0;
};

}  // namespace sonoband::exam
