#include "hal/tracker/station_stream.h"

#include <algorithm>

namespace sonoband {

namespace {

constexpr double hemisphere_slack_mm = 10;

}  // namespace

void StationStream::begin(int station, const LinkConfig& config, Duration period, std::uint32_t& next_epoch,
                          Stamp now) {
  const std::optional<PoseSample> last = last_;
  *this = StationStream();
  last_ = last;  // for the mark, and so that time goes on
  station_ = station;
  hemisphere_ = Eigen::Vector3f(config.hemisphere.data()).cast<double>();
  if (!hemisphere_.isZero()) hemisphere_.normalize();
  period_ = period;
  next_epoch_ = &next_epoch;
  last_heard_ = now;
  frames_ = FrameCounter(period);
  filter_ = ArrivalFilter(period);
  epoch_ = next_epoch++;
}

void StationStream::new_epoch() {
  epoch_ = (*next_epoch_)++;
  filter_.restart(period_);
  continuity_.restart();
  placed_frame_.reset();
}

std::optional<Reading> StationStream::take(const StationRecord& record, Stamp arrived, LinkCounters& counters,
                                           LinkReason& reason) {
  heard_ = true;
  last_heard_ = arrived;

  const bool same_pose = record.position_mm == last_record_.position_mm &&
                         record.quaternion_wxyz == last_record_.quaternion_wxyz;
  last_record_ = record;
  const FrameCounter::Verdict order = frames_.judge(record.frame, record.time_ms, same_pose);
  lost_ += order.lost;
  switch (order.step) {
    case FrameCounter::Step::duplicate:
      ++counters.duplicates;
      return std::nullopt;
    case FrameCounter::Step::doubtful:
      ++counters.doubtful;
      return std::nullopt;
    case FrameCounter::Step::new_epoch:
      new_epoch();
      break;
    case FrameCounter::Step::in_order:
      break;
  }

  std::optional<Stamp> time = filter_.on_arrival(record.frame, arrived);
  if (filter_.broken() != broken_) {
    broken_ = filter_.broken();
    epoch_ = (*next_epoch_)++;
  }

  Reading reading;
  reading.station = station_;
  PoseSample& pose = reading.pose;
  pose.quality = PoseQuality::good;
  const auto worse = [&](PoseQuality q, LinkReason r) {
    pose.quality = q;
    reason = r;
  };
  if (record.reason != LinkReason::none) worse(record.quality, record.reason);

  const Eigen::Vector4d& wxyz = record.quaternion_wxyz;
  Eigen::Quaterniond q = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
  // A unit that was told its hemisphere reports nothing outside it, so this is damage; a first reading has no
  // predecessor that would show it.
  const bool outside_hemisphere = record.position_mm.dot(hemisphere_) < -hemisphere_slack_mm;
  if (outside_hemisphere) {
    ++counters.mirrored;
    worse(PoseQuality::outside, LinkReason::mirrored);
  } else if (usable(pose.quality) || pose.quality == PoseQuality::distorted) {
    const std::uint32_t frames = placed_frame_ ? record.frame - *placed_frame_ : 0;
    placed_frame_ = record.frame;
    switch (continuity_.judge(record.position_mm, q, frames * period_)) {
      case PoseContinuity::Step::follows:
        break;
      case PoseContinuity::Step::mirrored:
        ++counters.mirrored;
        worse(PoseQuality::outside, LinkReason::mirrored);
        break;
      case PoseContinuity::Step::jumped:
        ++counters.jumps;
        return std::nullopt;
      case PoseContinuity::Step::new_place:
        epoch_ = (*next_epoch_)++;
        break;
    }
  }

  if (!time) {
    ++counters.settling;
    return std::nullopt;
  }
  if (last_ && *time <= last_->time) *time = last_->time + Duration(1);
  pose.time = *time;
  pose.tracker_from_probe = rigid<frame::Tracker, frame::Probe>(q, record.position_mm);
  pose.epoch = epoch_;
  pose.device_frame = record.frame;
  pose.device_ms = record.time_ms.value_or(0);
  pose.arrived = arrived;
  last_ = pose;
  ++counters.readings;
  return reading;
}

std::optional<Reading> StationStream::mark_missing(Stamp now) {
  if (!last_ || last_->quality == PoseQuality::missing) return std::nullopt;
  last_->quality = PoseQuality::missing;
  last_->time = std::min(last_->time + period_ / 2, std::max(now, last_->time + Duration(1)));
  last_->arrived = now;
  return Reading{station_, *last_};
}

}  // namespace sonoband
