// A sweep of the frame ring, as the recorder reads it.
#pragma once

#include "app/exam/recorder.h"
#include "core/concurrency/spsc_queue.h"
#include "core/sweep/sweep.h"

namespace sonoband::exam {

// Numbers the frames from the pre-roll to the release. Holds the ring's slots until the recorder lets go.
class RingSweep final : public SweepSource {
 public:
  // `readings`: where acquisition puts every reading of the tracker while this sweep grows; the recorder
  // takes them out. It must outlive the recorder's interest; null: raw readings are not saved.
  explicit RingSweep(Sweep sweep, SpscQueue<PoseSample>* readings = nullptr)
      : sweep_(std::move(sweep)), readings_(readings) {}

  bool finished() const override { return sweep_.released().has_value(); }
  std::int64_t published() const override;
  FrameRecord frame(std::int64_t number) const override;
  std::size_t take_poses(std::span<PoseSample> out) override;
  std::vector<Counter> ledger() const override;

 private:
  Sweep sweep_;
  SpscQueue<PoseSample>* readings_;
};

}  // namespace sonoband::exam
