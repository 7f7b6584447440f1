// What can go wrong with the simulated tracker, as a schedule of values.
#pragma once

#include <cstdint>

#include "core/time.h"

namespace sonoband::sim {

enum class FaultKind : std::uint8_t {
  // On the wire. One record each unless said otherwise.
  garbage,       // `value` random bytes, tags among them, before the next record
  dropped_byte,  // the byte at offset `value` of a record is lost
  flipped_size,  // bit `value` of a record's size field is inverted
  wrong_list,    // for `lasts`: records of another output list
  not_finite,    // float `value` (0..2 position, 3..6 quaternion) is NaN
  infinite,      // the same, infinite
  zero_quaternion,
  negated_quaternion,  // for `lasts`: q is sent as -q
  mirrored,            // for `lasts`: the position is sent as its negative
  displaced,           // the position is off by `value` mm along x: damage that no range shows
  distortion,          // for `lasts`: level `value`
  error_letter,        // for `lasts`: error byte `value`
  error_text,          // a text frame with error byte `value` between two records
  duplicate_record,
  missing_records,     // `value` records are not sent
  damaged_counter,     // the frame count is off by `value` in one record
  counters_back,       // frame count and clock step back by `value` frames
  counters_near_wrap,  // frame count and clock jump to `value` frames before 2^32
  flood,               // `value` bytes of ASCII records at once
  // Of the unit.
  station_silent,           // for `lasts`: station `station` is unplugged
  ignored_starts,           // the next `value` `C` are not heard
  stream_stops,             // continuous output ends by itself; `C` brings it back
  settings_lost,            // back to power-up settings, silent; configuring brings it back
  deaf_until_reset,         // no answer and no record until a USB reset
  deaf_until_reinitialise,  // until `^Y`
  deaf,                     // for `lasts`, whatever is done
  // Of USB.
  late,           // for `lasts`: what is sent arrives together at the end
  stall,          // the endpoint halts; again after each clear_halt for `lasts`
  io_error,       // the next `value` transfers fail
  unplugged,      // for `lasts`: off the bus, in the middle of a record; the unit stays powered and streaming
  power_cycle,    // for `lasts`: off; then it is there as its loader, then gone, then running
  access_denied,  // for `lasts`
  busy,           // for `lasts`
};

struct Fault {
  Stamp at{};
  FaultKind kind{};
  double value = 0;
  Duration lasts{};
  int station = 1;
};

}  // namespace sonoband::sim
