// The values that go into and come out of the link's state machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/sweep/pose_sample.h"
#include "core/time.h"
#include "hal/tracker/byte_port.h"

namespace sonoband {

enum class RecordRate : std::uint8_t { hz_120, hz_240 };

constexpr int most_stations = 16;  // of any unit

struct LinkConfig {
  int probe_station = 1;                     // where the probe's sensor is plugged in
  RecordRate rate = RecordRate::hz_240;      // of a LIBERTY or VIPER; a PATRIOT always gives 60 Hz
  std::array<float, 3> hemisphere{1, 0, 0};  // from the source towards the couch, any length
  // No record for so long: the stream has stopped. A station's poses are marked missing after a fifth of it,
  // and never sooner than after five periods.
  Duration silent = std::chrono::milliseconds(250);
};

// One turn of the machine: what came in, and when.
struct LinkInput {
  Stamp now{};                                    // when the read returned: the arrival stamp of `bytes`
  PortState port = PortState::absent;             // as open() said, or gone once a transfer said so
  TrackerFamily family = TrackerFamily::liberty;  // of an open port
  TransferStatus transfer = TransferStatus::ok;   // the worse of the write and the read since the last turn
  std::span<const std::uint8_t> bytes{};          // at most LinkOutput::max_read
  bool recording =
      false;  // while true the unit is not restarted, whatever happens: it would be gone for 10 s
};

// What the owner of the port does before the next turn, in this order.
struct LinkOutput {
  static constexpr std::size_t max_read = 4096;
  enum class PortAction : std::uint8_t { none, open, clear_halt, reset, release };

  PortAction action = PortAction::none;
  std::span<const std::uint8_t> write{};  // lives until the next turn
  bool listen = false;                    // read until something comes or `wake`; else only wait until `wake`
  Stamp wake{};                           // the next turn's latest time
};

enum class LinkState : std::uint8_t {
  absent,
  loader,
  access_denied,
  busy,
  stranger,
  quiescing,
  identifying,
  configuring,
  verifying,
  starting,
  streaming,
  reopening,       // after a USB reset of ours
  reinitialising,  // the unit restarts itself; deaf for 10 s
  fault,           // tried everything; tries again every 10 s
  closing,
  closed,
};

// What is wrong, or "all is well". Each has one sentence for the operator.
enum class LinkReason : std::uint8_t {
  none,
  no_device,
  loader,
  access_denied,
  busy,
  stranger,  // something else of the vendor's
  waking,    // no answer, but it came less than 15 s ago
  no_quiet,  // bytes keep coming after the stop command
  no_answer,
  refused,       // a setting was answered by an error
  mismatch,      // a setting reads back as something else
  no_records,    // settings stand, the stream does not start
  silent,        // the stream stopped
  probe_silent,  // only the probe's sensor stopped, or none is plugged in
  wrong_format,  // much of the stream is no record
  stalled,
  io_error,
  hardware,  // the unit says that one of its processors failed
  reinitialising,
  source_fault,
  self_test,
  outside_map,
  some_distortion,
  high_distortion,
  mirrored,
};
const char* operator_sentence(LinkReason reason);  // static storage; "" for none

// A pose of one station.
struct Reading {
  int station = 0;
  PoseSample pose;
};

struct LinkCounters {
  std::uint64_t readings = 0;  // handed out, marks of missing poses not counted
  std::uint64_t lost = 0;      // never arrived, or arrived damaged (probe's station)
  std::uint64_t duplicates = 0;
  std::uint64_t bad_values = 0;  // records refused for their values
  std::uint64_t doubtful = 0;    // records refused for their count or time
  std::uint64_t jumps = 0;       // records refused for their distance from the one before
  std::uint64_t mirrored = 0;    // records on the wrong side of the hemisphere plane
  std::uint64_t settling = 0;    // records before the arrival filter had settled
  std::uint64_t resync_events = 0;
  std::uint64_t resync_bytes = 0;
  std::uint64_t truncated = 0;
  std::uint64_t notices = 0;  // texts and warnings from the unit
  std::uint64_t stalls = 0;
  std::uint64_t io_errors = 0;
  std::uint32_t recoveries = 0;  // rungs of the recovery ladder taken
  std::uint8_t last_error = 0;   // of the unit's error bytes, the last that was not "none"
};

}  // namespace sonoband
