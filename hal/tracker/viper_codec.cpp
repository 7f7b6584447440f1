#include "hal/tracker/viper_codec.h"

#include <cassert>
#include <cmath>

#include "hal/tracker/little_endian.h"
#include "hal/tracker/streaming.h"

namespace sonoband {

using namespace viper;

namespace {

// Of 0 to 255. The vendor gives the number no meaning; these are to be set on a real unit.
constexpr int some_distortion = 64;
constexpr int high_distortion = 192;

bool possible(const SensorPose& p) {
  constexpr double farthest_mm = 5000;
  constexpr double norm_tolerance = 0.01;
  return p.position_mm.allFinite() && p.position_mm.cwiseAbs().maxCoeff() <= farthest_mm &&
         p.quaternion_wxyz.allFinite() && std::abs(p.quaternion_wxyz.norm() - 1) <= norm_tolerance;
}

StationRecord record_of(const PoseHeader& header, const SensorPose& pose) {
  StationRecord r{.station = pose.sensor + 1,
                  .frame = header.frame,
                  .time_ms = {},
                  .position_mm = pose.position_mm,
                  .quaternion_wxyz = pose.quaternion_wxyz};
  if (header.self_test_error != 0) r.quality = PoseQuality::degraded, r.reason = LinkReason::self_test;
  if (pose.distortion >= some_distortion)
    r.quality = PoseQuality::degraded, r.reason = LinkReason::some_distortion;
  if (pose.distortion >= high_distortion)
    r.quality = PoseQuality::distorted, r.reason = LinkReason::high_distortion;
  return r;
}

}  // namespace

QuietWords ViperCodec::quiet_words() const {
  const WireCommand stop = make_order(Order::continuous, Action::reset);
  return {.stop = stop, .stop_again = stop, .end_line = {}};
}

void ViperCodec::begin_setup(const LinkConfig& config, Stamp now) {
  parser_.reset();
  patience_ = from_seconds(0.1);
  setup_.begin(config, now);
}

void ViperCodec::hear_answers(std::span<const std::uint8_t> bytes, Stamp now) {
  [[maybe_unused]] const std::size_t taken = parser_.push(bytes, now);
  assert(taken == bytes.size());
  Frame frame;
  while (parser_.next(frame, now, patience_)) setup_.take(frame);
}

Duration ViperCodec::begin_stream(const LinkConfig& config) {
  const Duration period = from_seconds(config.rate == RecordRate::hz_240 ? 1.0 / 240 : 1.0 / 120);
  patience_ = 3 * period;
  return period;
}

WireCommand ViperCodec::start(bool reset_counters) const {
  std::array<std::uint8_t, 4> count{};
  wire::store_u32(count.data(), reset_counters ? 0 : 0xffffffff);  // all ones: keep it
  return make_order(Order::continuous, Action::set, 0, 0, count);
}

void ViperCodec::hear_records(std::span<const std::uint8_t> bytes, Stamp now, Streaming& streaming,
                              LinkCounters& counters) {
  [[maybe_unused]] const std::size_t taken = parser_.push(bytes, now);
  assert(taken == bytes.size());
  Frame frame;
  while (parser_.next(frame, now, patience_)) {
    if (!frame.poses)
      hear_reply(frame, counters);
    else if (!hear_poses(frame, streaming, counters))
      parser_.disown(frame);
  }
}

void ViperCodec::hear_reply(const Frame& frame, LinkCounters& counters) {
  const auto reply = decode_reply(frame);
  if (!reply || reply->action == Action::ack) return;
  ++counters.notices;
  if (!reply->payload.empty()) counters.last_error = reply->payload[0];
}

// False if it is not of the units that were set: after a while of that the link configures the unit anew.
bool ViperCodec::hear_poses(const Frame& frame, Streaming& streaming, LinkCounters& counters) {
  const auto header = decode_pose_header(frame);
  if (!header) return false;
  for (int i = 0; i < header->sensors; ++i) {
    const SensorPose pose = decode_sensor(frame, i);
    if (pose.angle_units != AngleUnits::quaternion || pose.position_units != PositionUnits::centimetre)
      return false;
    if (pose.is_virtual || pose.sensor >= max_sensors) continue;
    if (possible(pose))
      streaming.take(record_of(*header, pose), frame.arrived, counters);
    else
      streaming.take_impossible(frame.arrived, counters);
  }
  return true;
}

WireCommand ViperCodec::reinitialise() const {
  return make_order(Order::initialise, Action::set);
}

}  // namespace sonoband
