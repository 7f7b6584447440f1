#include "hal/tracker/liberty_codec.h"

#include <cassert>

#include "hal/tracker/liberty_commands.h"
#include "hal/tracker/streaming.h"

namespace sonoband {

using namespace liberty;

namespace {

Duration period_of(Tag tag, RecordRate rate) {
  if (tag == Tag::patriot) return from_seconds(1.0 / 60);
  return from_seconds(rate == RecordRate::hz_240 ? 1.0 / 240 : 1.0 / 120);
}

WireCommand joined(WireCommand a, const WireCommand& b) {
  for (const std::uint8_t byte : b.bytes()) a.storage[a.size++] = byte;
  return a;
}

// What the error byte and the distortion of a record say about its pose.
void judge(const Record& record, StationRecord& out) {
  const auto worse = [&](PoseQuality quality, LinkReason reason) {
    out.quality = quality;
    out.reason = reason;
  };
  switch (classify(record.error)) {
    case ErrorKind::none:
    case ErrorKind::notice:
      break;
    case ErrorKind::self_test:
      worse(PoseQuality::degraded, LinkReason::self_test);
      break;
    case ErrorKind::outside_map:
      worse(PoseQuality::outside, LinkReason::outside_map);
      break;
    default:
      worse(PoseQuality::fault, LinkReason::source_fault);
      break;
  }
  if (!usable(out.quality)) return;
  if (*record.distortion == 1) worse(PoseQuality::degraded, LinkReason::some_distortion);
  if (*record.distortion == 2) worse(PoseQuality::distorted, LinkReason::high_distortion);
}

}  // namespace

QuietWords LibertyCodec::quiet_words() const {
  return {.stop = command::poll(),
          .stop_again = joined(command::end_line(), command::poll()),
          .end_line = command::end_line()};
}

void LibertyCodec::begin_setup(const LinkConfig& config, Stamp now) {
  parser_.reset();
  parser_.expect({});
  setup_.begin(config, now);
}

void LibertyCodec::hear_answers(std::span<const std::uint8_t> bytes, Stamp now) {
  [[maybe_unused]] const std::size_t taken = parser_.push(bytes, now);
  assert(taken == bytes.size());
  Packet packet;
  while (parser_.next(packet, now)) setup_.take(packet);
}

SetupProgress LibertyCodec::setup_progress() const {
  const StationMap stations = setup_.stations();
  return {.stage = setup_.stage(),
          .wake = setup_.wake(),
          .notices = setup_.notices(),
          .last_error = setup_.last_error(),
          .sensor_present = (stations.detected & stations.active) != 0};
}

Duration LibertyCodec::begin_stream(const LinkConfig& config) {
  const Duration period = period_of(setup_.identity().tag, config.rate);
  parser_.expect({.tag = setup_.identity().tag,
                  .stream_body_bytes = tracking_list.body_bytes(),
                  .incomplete_limit = 3 * period});
  return period;
}

WireCommand LibertyCodec::start(bool reset_counters) const {
  const WireCommand stream = command::start_continuous();
  return reset_counters ? joined(command::reset_counters(), stream) : stream;
}

void LibertyCodec::hear_records(std::span<const std::uint8_t> bytes, Stamp now, Streaming& streaming,
                                LinkCounters& counters) {
  [[maybe_unused]] const std::size_t taken = parser_.push(bytes, now);
  assert(taken == bytes.size());
  Packet packet;
  while (parser_.next(packet, now)) hear_record(packet, streaming, counters);
}

void LibertyCodec::hear_record(const Packet& packet, Streaming& streaming, LinkCounters& counters) {
  if (classify(packet.error) != ErrorKind::none) counters.last_error = packet.error;
  // The refusal of a command is of no station, whatever its body looks like.
  const auto record = packet.command == stream_command && packet.station >= 1
                          ? decode_record(packet, tracking_list, Units::centimetres)
                          : std::nullopt;
  if (!record) {
    if (classify(packet.error) == ErrorKind::hardware) streaming.hardware_failed();
    ++counters.notices;
    return;
  }
  if (check_values(*record) != ValueFault::none) {
    streaming.take_impossible(packet.arrived, counters);
    return;
  }
  StationRecord out{.station = record->station,
                    .frame = *record->frame,
                    .time_ms = record->time_ms,
                    .position_mm = *record->position_mm,
                    .quaternion_wxyz = *record->quaternion_wxyz};
  judge(*record, out);
  streaming.take(out, packet.arrived, counters);
}

WireCommand LibertyCodec::reinitialise() const {
  return command::reinitialise();
}

}  // namespace sonoband
