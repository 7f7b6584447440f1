// What differs between families of trackers; the link above it is the same for all.
//
// A codec turns bytes into answers during setup and into records while streaming, and knows the words for
// both. Like the link it owns no port, no thread and no clock.
#pragma once

#include <cstdint>
#include <span>

#include "hal/tracker/link_types.h"
#include "hal/tracker/wire_command.h"

namespace sonoband {

class Streaming;

// How to make a unit quiet, see quiesce.h.
struct QuietWords {
  WireCommand stop;        // ends a running stream
  WireCommand stop_again;  // when the stream goes on all the same
  WireCommand end_line;    // flushes a half-typed command; empty where commands are framed
};

enum class SetupStatus : std::uint8_t { busy, done, no_answer, refused, mismatch, hardware };
enum class SetupStage : std::uint8_t { identify, configure, verify };

struct SetupProgress {
  SetupStage stage = SetupStage::identify;
  Stamp wake{};
  std::uint32_t notices = 0;
  std::uint8_t last_error = 0;
  bool sensor_present = false;  // once done: there is something to hear
};

struct WireCounters {
  std::uint64_t frames = 0;
  std::uint64_t resync_events = 0;
  std::uint64_t resync_bytes = 0;  // every byte that belongs to no frame handed out
  std::uint64_t truncated = 0;     // frames whose rest never came
};

class Codec {
 public:
  virtual ~Codec() = default;

  virtual QuietWords quiet_words() const = 0;
  virtual void forget_bytes() = 0;  // for a fresh start of the conversation
  virtual const WireCounters& wire_counters() const = 0;

  virtual void begin_setup(const LinkConfig& config, Stamp now) = 0;
  virtual void hear_answers(std::span<const std::uint8_t> bytes, Stamp now) = 0;
  virtual SetupStatus setup_turn(Stamp now, WireCommand& write) = 0;
  virtual SetupProgress setup_progress() const = 0;
  virtual const char* identity() const = 0;  // the unit's own words, of the last setup

  // For each start of the stream; gives the period of its records.
  virtual Duration begin_stream(const LinkConfig& config) = 0;
  virtual WireCommand start(bool reset_counters) const = 0;
  virtual void hear_records(std::span<const std::uint8_t> bytes, Stamp now, Streaming& streaming,
                            LinkCounters& counters) = 0;

  virtual WireCommand reinitialise() const = 0;  // like switching off and on
};

}  // namespace sonoband
