// Making sure nobody is talking: whoever used the unit before may have left it streaming, in ASCII or binary,
// or with half a command typed. One word stops the stream, another ends the line (LIBERTY: `P` and CR; a
// VIPER has no lines), and both times everything is read and thrown away until 100 ms of silence. A stream
// that goes on for 2 s or 64 KiB swallowed the stop as part of a half-typed line: so it is sent again after a
// line end.
//
// The unit sends no greeting on USB: silence is normal.
#pragma once

#include <cstddef>

#include "core/time.h"
#include "hal/tracker/codec.h"

namespace sonoband {

class Quiesce {
 public:
  enum class Status : std::uint8_t { busy, quiet, no_quiet };
  enum class Purpose : std::uint8_t { connect, leave };  // leave: only stop the stream

  void begin(Purpose purpose, const QuietWords& words, Stamp now);
  // `bytes` came since the last turn. When `write` has a size it is to be sent.
  Status turn(Stamp now, std::size_t bytes, WireCommand& write);
  Stamp wake() const;

 private:
  enum class Stage : std::uint8_t { stop, stopping, end_line, ending_line };
  void send(Stage next, Stamp now);

  QuietWords words_;
  Purpose purpose_ = Purpose::connect;
  Stage stage_ = Stage::stop;
  int attempts_ = 0;
  std::size_t drained_ = 0;
  Stamp sent_{};
  Stamp last_bytes_{};
};

}  // namespace sonoband
