#include "hal/tracker/streaming.h"

#include <algorithm>
#include <cassert>

namespace sonoband {

namespace {

constexpr Duration complaint_holds = std::chrono::milliseconds(500);
constexpr std::uint64_t unframed_limit = 1000;  // bytes a second; one station at 240 Hz sends 11520

}  // namespace

void Streaming::begin(const LinkConfig& config, Duration period, Stamp now) {
  assert(config.probe_station >= 1 && config.probe_station <= most_stations);
  config_ = config;
  period_ = period;
  for (int s = 1; s <= most_stations; ++s)
    stations_[static_cast<std::size_t>(s - 1)].begin(s, config, period, next_epoch_, now);
  heard_ = false;
  last_heard_ = now;
  probe_silent_ = false;
  complaint_ = LinkReason::none;
  hardware_failed_ = false;
  second_began_ = now;
  unframed_then_ = ~std::uint64_t{0};
}

void Streaming::put(const Reading& reading) {
  assert(count_ < max_readings);
  if (count_ < max_readings) readings_[count_++] = reading;
}

void Streaming::take_impossible(Stamp arrived, LinkCounters& counters) {
  heard_ = true;
  last_heard_ = arrived;
  ++counters.bad_values;
}

void Streaming::take(const StationRecord& record, Stamp arrived, LinkCounters& counters) {
  assert(record.station >= 1 && record.station <= most_stations);
  heard_ = true;
  last_heard_ = arrived;
  LinkReason complaint = LinkReason::none;
  StationStream& station = stations_[static_cast<std::size_t>(record.station - 1)];
  const std::uint64_t lost_before = station.lost();
  if (const auto reading = station.take(record, arrived, counters, complaint)) put(*reading);
  if (record.station == config_.probe_station) {
    counters.lost += station.lost() - lost_before;
    probe_silent_ = false;
    if (complaint != LinkReason::none) {
      complaint_ = complaint;
      complained_ = arrived;
    }
  }
}

LinkReason Streaming::watch(Stamp now, std::uint64_t unframed_bytes) {
  if (hardware_failed_) return LinkReason::hardware;

  const Duration limit = std::max(5 * period_, config_.silent / 5);
  for (StationStream& s : stations_)
    if (s.heard() && now - s.last_heard() > limit)
      if (const auto mark = s.mark_missing(now)) put(*mark);
  probe_silent_ = now - probe().last_heard() > limit;
  if (now - last_heard_ > config_.silent) return LinkReason::silent;

  if (unframed_then_ == ~std::uint64_t{0}) unframed_then_ = unframed_bytes;
  if (now - second_began_ >= std::chrono::seconds(1)) {
    const bool too_many = unframed_bytes - unframed_then_ > unframed_limit;
    second_began_ = now;
    unframed_then_ = unframed_bytes;
    if (too_many) return LinkReason::wrong_format;
  }
  return LinkReason::none;
}

void Streaming::mark_all_missing(Stamp now) {
  for (StationStream& s : stations_)
    if (const auto mark = s.mark_missing(now)) put(*mark);
}

LinkReason Streaming::complaint(Stamp now) const {
  if (probe_silent_) return LinkReason::probe_silent;
  return now - complained_ <= complaint_holds ? complaint_ : LinkReason::none;
}

}  // namespace sonoband
