// Commands to a LIBERTY or PATRIOT, as the exact bytes. They are ASCII even while the answers are binary, and
// end in CR; only `P` has no terminator. A setting that is accepted is answered by silence, so the link reads
// settings back.
#pragma once

#include <cstdint>

#include "hal/tracker/liberty_protocol.h"
#include "hal/tracker/wire_command.h"

namespace sonoband::liberty {

using Command = WireCommand;

constexpr int all_stations = 0;  // written '*'

struct Vector3 {
  float x = 0, y = 0, z = 0;
};

enum class Rate : std::uint8_t { hz_120 = 3, hz_240 = 4 };  // LIBERTY only: a PATRIOT refuses the command

namespace command {

Command start_continuous();  // C
Command poll();              // P: one record of each station, and the end of continuous output
Command end_line();          // CR alone: ends a half-typed command of whoever was here before

Command binary(bool on);       // F
Command centimetres(bool on);  // U
Command output_list(int station, const OutputList& list);
Command rate(Rate r);
// The half space the sensor moves in, as a vector from the source; (0,0,0) lets the unit follow the sensor,
// which is right only if the sensor starts inside the hemisphere set before.
Command hemisphere(int station, Vector3 towards);
Command position_filter_off();  // the manual contradicts itself on the default: never assume it is off
Command attitude_filter_off();
Command external_sync(bool on);
Command clear_boresight(int station);
Command clear_alignment(int station);
Command clear_tip_offset(int station);
Command clear_mounting_frame();  // LIBERTY only
Command reset_counters();
Command echo(bool on);
// Off: a slow host sees gaps in the frame count. On (the default): it sees stale records, up to 2300 bytes
// (196 ms at 240 Hz, one sensor), then gaps.
Command usb_buffering(bool on);
Command clear_self_test();
// Like switching off and on: 5 to 10 s of self-test, then the settings of the start-up slot.
Command reinitialise();

Command ask_binary();
Command ask_units();
Command ask_output_list(int station);
Command ask_rate();
Command ask_position_filter();
Command ask_attitude_filter();
Command ask_usb_buffering();
Command ask_hemisphere(int station);
Command ask_stations();
Command ask_identity();
Command ask_sensor_identity(int station);
Command ask_self_test();

}  // namespace command

// The byte by which a reply to a control command is known: control('V') is 0x16.
constexpr std::uint8_t control(char letter) {
  return static_cast<std::uint8_t>(letter - '@');
}

}  // namespace sonoband::liberty
