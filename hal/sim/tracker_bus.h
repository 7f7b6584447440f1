// A tracker behind a byte port: its unit, its USB plug and the host's side of the bus, with everything that
// goes wrong there. Nothing above the port can tell it from the device.
//
// Time comes from the clock alone: read() computes what the unit has sent by now and sleeps on the clock for
// what comes next, so it runs in real time or under a virtual clock, and the same seed gives the same bytes.
// After construction it takes no heap (the pose function aside).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hal/clock.h"
#include "hal/sim/liberty_faults.h"
#include "hal/sim/liberty_wire.h"
#include "hal/sim/tracker_unit.h"
#include "hal/tracker/byte_port.h"

namespace sonoband::sim {

struct TrackerBusConfig {
  std::size_t max_packet = 512;  // 64 at full speed
  // Transfers end where a record ends; else packets are filled up, so records straddle them.
  bool record_per_transfer = true;
  std::size_t split_at = 0;  // every record arrives in two pieces, the second half a millisecond later
  double zero_length = 0;    // probability that a read brings an empty packet
  double late_status = 0;    // probability that a read which brings bytes says it timed out
  Duration jitter = std::chrono::milliseconds(2);  // arrivals are late by up to this, evenly
  double bursts_per_minute = 1;                    // 20 to 50 ms in which nothing arrives, then all at once
};

// Makes the unit, which sends into `sink`.
using MakeUnit = std::function<std::unique_ptr<TrackerUnit>(TrackerUnit::Sink sink, Stamp now)>;

class TrackerBus : public BytePort {
 public:
  TrackerBus(Clock& clock, TrackerFamily family, const TrackerBusConfig& bus, std::vector<Fault> faults,
             std::uint64_t seed, const MakeUnit& make_unit);

  PortState open() override;
  TrackerFamily family() const override { return family_; }
  Transfer write(std::span<const std::uint8_t> bytes) override;
  Transfer read(std::span<std::uint8_t> into, Duration timeout) override;
  void clear_halt() override;
  void close(Closing how) override;

 private:
  // A record or reply on its way.
  struct Chunk {
    Stamp arrives{};
    int record_station = 0;
    std::size_t taken = 0;
    WireBytes bytes;
  };
  struct Plug {
    Stamp away_until{};
    Stamp loader_until{};
    Stamp off_bus_until{};  // between loader and running
    Stamp denied_until{};
    Stamp busy_until{};
    bool left = false;  // while open
  };

  void advance(Stamp now);
  void inject(const Fault& fault);
  void on_sent(Stamp sent, std::span<const std::uint8_t> bytes, int record_station);
  void tear_newest();
  Chunk& chunk(std::size_t i) { return chunks_[(first_ + i) % chunks_.size()]; }
  bool present(Stamp t) const;
  Transfer take(std::span<std::uint8_t> into, Stamp now);
  double uniform();

  Clock& clock_;
  const TrackerFamily family_;
  const TrackerBusConfig bus_;
  std::vector<Fault> faults_;  // by time
  std::size_t next_fault_ = 0;
  std::unique_ptr<TrackerUnit> unit_;

  std::vector<Chunk> chunks_;  // circular
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Stamp last_arrival_{};
  Stamp late_until_{};
  Stamp next_burst_{};
  Stamp second_piece_{};

  bool open_ = false;
  bool halted_ = false;
  Stamp stalls_until_{};
  int io_errors_ = 0;
  Plug plug_;
  std::uint64_t seed_;
  std::uint64_t random_ = 0;
};

}  // namespace sonoband::sim
