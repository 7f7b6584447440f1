// The running stream of all stations: records to readings, and the watchdogs that see what no error code
// says. An unplugged sensor sends nothing at all, and a unit that hangs does not either.
//
// | seen                                                        | verdict                               |
// |-------------------------------------------------------------|---------------------------------------|
// | a station silent for more than 5 periods and 50 ms (*)      | its poses are marked missing          |
// | all silent for more than 250 ms (*)                         | silent                                |
// | more than 1000 bytes a second that belong to no frame       | wrong_format                          |
// | an error frame that names failed electronics                | hardware                              |
// (*) LinkConfig::silent, and a fifth of it
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/tracker/link_types.h"
#include "hal/tracker/station_stream.h"

namespace sonoband {

class Streaming {
 public:
  static constexpr std::size_t max_readings = 128;  // of one turn: 4096 bytes hold 85 records

  explicit Streaming(std::uint32_t first_epoch) : next_epoch_(first_epoch) {}
  Streaming(const Streaming&) = delete;  // the stations hold a pointer to next_epoch_
  Streaming& operator=(const Streaming&) = delete;

  // For each start or restart: new epochs for all stations.
  void begin(const LinkConfig& config, Duration period, Stamp now);
  void clear_readings() { count_ = 0; }

  void take(const StationRecord& record, Stamp arrived, LinkCounters& counters);
  // A record came, but of impossible values: no reading, though not silence either.
  void take_impossible(Stamp arrived, LinkCounters& counters);
  void hardware_failed() { hardware_failed_ = true; }
  // none while all is well; `unframed_bytes` is the parser's running count.
  LinkReason watch(Stamp now, std::uint64_t unframed_bytes);
  void mark_all_missing(Stamp now);

  std::span<const Reading> readings() const { return {readings_.data(), count_}; }
  bool probe_heard() const { return probe().heard(); }
  bool heard() const { return heard_; }
  std::uint32_t next_epoch() const { return next_epoch_; }
  // What is wrong while records do come; holds for half a second after it was last seen.
  LinkReason complaint(Stamp now) const;

 private:
  void put(const Reading& reading);
  const StationStream& probe() const {
    return stations_[static_cast<std::size_t>(config_.probe_station - 1)];
  }

  LinkConfig config_;
  Duration period_{};
  std::array<StationStream, most_stations> stations_;
  std::uint32_t next_epoch_;
  std::array<Reading, max_readings> readings_;
  std::size_t count_ = 0;

  bool heard_ = false;
  Stamp last_heard_{};
  bool probe_silent_ = false;
  LinkReason complaint_ = LinkReason::none;
  Stamp complained_{};
  bool hardware_failed_ = false;
  Stamp second_began_{};
  std::uint64_t unframed_then_ = 0;
};

}  // namespace sonoband
