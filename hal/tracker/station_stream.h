// One station's records to readings: order, plausibility, time, quality, epoch.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/tracker/arrival_filter.h"
#include "hal/tracker/frame_counter.h"
#include "hal/tracker/link_types.h"
#include "hal/tracker/pose_continuity.h"

namespace sonoband {

// One record of one station, whatever the wire looked like.
struct StationRecord {
  int station = 0;
  std::uint32_t frame = 0;
  std::optional<std::uint32_t> time_ms;  // the device's clock; empty where it sends none
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion_wxyz{1, 0, 0, 0};  // about unit length, of either sign
  PoseQuality quality = PoseQuality::good;      // as the unit itself judges it
  LinkReason reason = LinkReason::none;         // and why
};

class StationStream {
 public:
  // For each start of the stream. `next_epoch` is shared by all stations and gives out epoch ids.
  void begin(int station, const LinkConfig& config, Duration period, std::uint32_t& next_epoch, Stamp now);

  // A record of possible values; counts what it refuses in `counters`. `reason` gets what is wrong with the
  // pose, if anything.
  std::optional<Reading> take(const StationRecord& record, Stamp arrived, LinkCounters& counters,
                              LinkReason& reason);

  // A reading that says "nothing here": its time is just after the last one's, so that no pose is
  // interpolated from before the silence. Empty if the last reading was such a mark or there was none.
  std::optional<Reading> mark_missing(Stamp now);

  bool heard() const { return heard_; }
  Stamp last_heard() const { return last_heard_; }
  std::uint64_t lost() const { return lost_; }  // since begin, by the device's count

 private:
  void new_epoch();

  int station_ = 0;
  Eigen::Vector3d hemisphere_ = Eigen::Vector3d::Zero();  // unit length; zero: the unit follows the sensor
  Duration period_{};
  std::uint32_t* next_epoch_ = nullptr;
  std::uint32_t epoch_ = 0;
  bool heard_ = false;
  Stamp last_heard_{};
  std::uint64_t lost_ = 0;
  StationRecord last_record_;
  std::optional<std::uint32_t> placed_frame_;  // of the last record whose pose was judged
  std::uint32_t broken_ = 0;
  FrameCounter frames_;
  PoseContinuity continuity_;
  ArrivalFilter filter_;
  std::optional<PoseSample> last_;
};

}  // namespace sonoband
