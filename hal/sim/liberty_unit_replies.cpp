// The unit's answers and refusals as bytes, binary or ASCII as it is set.
#include "hal/sim/liberty_unit.h"
#include "hal/tracker/liberty_commands.h"

namespace sonoband::sim {

using liberty::control;
using liberty::OutputList;
using liberty::Tag;

namespace {

constexpr std::uint8_t caret_u = control('U');
constexpr std::uint8_t caret_v = control('V');

}  // namespace

void LibertyUnit::begin_reply(int station, std::uint8_t command, std::uint8_t error_code) {
  reply_.size = 0;
  if (settings_.binary) {
    begin_frame(reply_, tag(), station, command, error_code);
  } else {
    reply_.format("%02.0f", station);
    reply_.byte(command);
    reply_.byte(error_code == 0 ? ' ' : error_code);
    reply_.byte(' ');
  }
}

void LibertyUnit::finish_reply(std::uint8_t /*command*/) {
  if (settings_.binary)
    finish_frame(reply_);
  else
    reply_.text("\r\n");
  sink_(now_, reply_.view(), 0);
}

void LibertyUnit::reply_i32(int station, std::uint8_t command, std::int32_t v) {
  begin_reply(station, command);
  if (settings_.binary)
    reply_.u32(static_cast<std::uint32_t>(v));
  else
    reply_.format("%.0f", v);
  finish_reply(command);
}

void LibertyUnit::reply_f32(int station, std::uint8_t command, std::span<const float> values) {
  begin_reply(station, command);
  for (const float v : values) {
    if (settings_.binary)
      reply_.f32(v);
    else
      reply_.format(" %.3f", static_cast<double>(v));
  }
  finish_reply(command);
}

void LibertyUnit::reply_output_list(int station) {
  const OutputList& list = settings_.lists[static_cast<std::size_t>(station - 1)];
  begin_reply(station, 'O');
  for (const std::uint8_t code : list.items()) {
    if (settings_.binary)
      reply_.u32(code);
    else
      reply_.format(" %.0f", code);
  }
  if (settings_.binary) reply_.u32(0xffffffffU);
  finish_reply('O');
}

void LibertyUnit::reply_stations() {
  std::uint16_t detected = 0;
  for (int s = 1; s <= stations(); ++s)
    if (connected(s, now_)) detected = static_cast<std::uint16_t>(detected | 1U << (s - 1));
  begin_reply(0, caret_u);
  if (settings_.binary) {
    reply_.u16(detected);
    reply_.u16(static_cast<std::uint16_t>(detected & settings_.active));
  } else {
    reply_.format("%04.0f", detected);
  }
  finish_reply(caret_u);
}

void LibertyUnit::reply_identity(int station) {
  begin_reply(station, caret_v);
  if (station == 0) {
    if (settings_.binary) {
      reply_.byte(static_cast<std::uint8_t>(stations() == 2 ? 2 : 4));
      reply_.byte(0);
      reply_.byte(0);
    }
    reply_.text(tag() == Tag::patriot ? "Simulated PATRIOT" : "Simulated LIBERTY");
    reply_.text("\r\nSonoband\r\n");
    // The real one's is about 196 bytes.
    for (int i = 0; i < 140; ++i) reply_.byte(' ');
  } else {
    if (settings_.binary) reply_.u32(static_cast<std::uint32_t>(1000 + station));
    reply_.text("SIMULATED");
  }
  finish_reply(caret_v);
}

void LibertyUnit::error(std::uint8_t code, std::uint8_t command) {
  reply_.size = 0;
  if (settings_.binary) begin_frame(reply_, tag(), 0, command == 0 ? '?' : command, code);
  reply_.text(liberty::error_text(code));
  reply_.text("\r\n");
  if (settings_.binary) finish_frame(reply_);
  sink_(now_, reply_.view(), 0);
}

}  // namespace sonoband::sim
