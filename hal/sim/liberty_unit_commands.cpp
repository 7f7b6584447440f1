// The unit's side of the conversation: lines to commands, and what each does.
#include <string_view>

#include "hal/sim/liberty_unit.h"
#include "hal/tracker/liberty_commands.h"

namespace sonoband::sim {

using liberty::control;
using liberty::Tag;

namespace {

constexpr std::uint8_t invalid_command = 0x01;
constexpr std::uint8_t invalid_station = 0x02;
constexpr std::uint8_t invalid_parameter = 0x03;
constexpr std::uint8_t too_few = 0x04;
constexpr std::uint8_t too_many = 0x05;
constexpr std::uint8_t too_many_characters = 0x10;
constexpr std::uint8_t caret_b = control('B');
constexpr std::uint8_t caret_e = control('E');
constexpr std::uint8_t caret_k = control('K');
constexpr std::uint8_t caret_r = control('R');
constexpr std::uint8_t caret_t = control('T');
constexpr std::uint8_t caret_u = control('U');
constexpr std::uint8_t caret_v = control('V');
constexpr std::uint8_t caret_w = control('W');
constexpr std::uint8_t caret_y = control('Y');

}  // namespace

void LibertyUnit::receive(std::span<const std::uint8_t> bytes, Stamp now) {
  advance(now);
  for (const std::uint8_t b : bytes) {
    if (silent(now) &&
        !(deaf_ == Deaf::until_reinitialise && now >= deaf_until_ && (b == caret_y || b == '\r')))
      continue;
    const char c = static_cast<char>(b);
    if (line_size_ == 0 && (c == 'P' || c == 'p') && deaf_ == Deaf::no) {
      settings_.continuous = false;
      send_frame(now, now, 'P');
    } else if (c == '\r') {
      run_line(now);
      line_size_ = 0;
    } else if (c != '\n' || line_size_ > 0) {
      if (line_size_ == line_.size()) {
        error(too_many_characters, 0);
        line_size_ = 0;
      }
      line_[line_size_++] = c;
    }
  }
}

void LibertyUnit::run_line(Stamp now) {
  const std::string_view text(line_.data(), line_size_);
  const CommandLine c = parse_command_line({line_.data(), line_size_});
  if (c.error != 0) {
    error(c.error, c.command);
    return;
  }
  reply_.size = 0;
  execute(c, now);
  if (settings_.echo && reply_.size == 0 && c.count > 0) {
    begin_reply(0, c.command);
    for (const char ch : text) reply_.byte(static_cast<std::uint8_t>(ch));
    finish_reply(c.command);
  }
}

void LibertyUnit::execute(const CommandLine& c, Stamp now) {
  const bool is_patriot = tag() == Tag::patriot;
  switch (c.command) {
    case 'C':
      if (ignored_starts_ > 0)
        --ignored_starts_;
      else
        settings_.continuous = true;
      return;
    case 'F':
      return set_switch(c, settings_.binary);
    case 'U':
      return set_switch(c, settings_.centimetres);
    case 'R':
      if (is_patriot) return error(invalid_command, c.command);
      set_number(c, settings_.rate, 3, 4);
      if (c.count > 0) restart_ticks(now);
      return;
    case 'Z':
      return is_patriot ? error(invalid_command, c.command) : set_number(c, settings_.sync, 0, 1);
    case 'D':
      return is_patriot ? error(invalid_command, c.command) : set_number(c, settings_.compensation_map, 0, 3);
    case 'X':
      return set_filter(c, settings_.position_filter);
    case 'Y':
      return set_filter(c, settings_.attitude_filter);
    case 'Q': {
      const int which = c.integer(0).value_or(0);
      if (which < 0 || which > 2) return error(invalid_parameter, c.command);
      if (which != 2) frame_ = 0;
      if (which != 1) time_ms_ = 0;
      return;
    }
    case '@':
      return set_switch(c, settings_.buffering);
    case caret_e:
      return set_switch(c, settings_.echo);
    case caret_k: {
      const int slot = c.integer(0).value_or(0);
      if (slot < 1 || slot > 3) return error(invalid_parameter, c.command);
      stored_[static_cast<std::size_t>(slot)] = settings_;
      return;
    }
    case caret_w:
      return set_number(c, start_up_slot_, 0, 3);
    case caret_t: {
      if (c.count > 0) return;
      begin_reply(0, c.command);
      for (int i = 0; i < 9; ++i) reply_.u32(0);
      return finish_reply(c.command);
    }
    case caret_u:
      return set_stations(c);
    case caret_v: {
      const int station = c.integer(0).value_or(0);
      if (station < 0 || station > stations()) return error(invalid_station, c.command);
      return reply_identity(station);
    }
    case caret_y:
      deaf_ = Deaf::no;
      deaf_until_ = now + config_.self_test;
      return;
    case 'G':
      if (c.count == 0) return reply_f32(0, c.command, settings_.mounting_deg);
      if (c.count > 3) return error(too_many, c.command);
      for (int i = 0; i < c.count; ++i)
        if (const auto v = c.arguments[static_cast<std::size_t>(i)])
          settings_.mounting_deg[static_cast<std::size_t>(i)] = static_cast<float>(*v);
      return;
    case 'O':
    case 'H':
    case 'N':
    case 'L':
    case 'A':
    case 'B':
    case caret_b:
    case caret_r:
      break;
    default:
      return error(invalid_command, c.command);
  }
  if (c.count == 0) return error(too_few, c.command);
  if (c.every_station) {
    for (int s = 1; s <= stations(); ++s) execute_for_station(c, s, now);
    return;
  }
  const auto station = c.integer(0);
  if (!station || *station < 1 || *station > stations()) return error(invalid_station, c.command);
  execute_for_station(c, *station, now);
}

void LibertyUnit::execute_for_station(const CommandLine& c, int station, Stamp now) {
  const auto s = static_cast<std::size_t>(station - 1);
  switch (c.command) {
    case 'O':
      return set_output_list(c, station);
    case 'H':
      return set_vector(c, station, settings_.hemisphere, 3);
    case 'N':
      return set_vector(c, station, settings_.tip_offset, 3);
    case 'L':
      if (c.count == 1) return reply_i32(station, c.command, settings_.stylus_mode[s]);
      settings_.stylus_mode[s] = c.integer(1).value_or(0);
      return;
    case 'A':
      return set_alignment(c, station);
    case 'B':
      return set_boresight(c, station, now);
    case caret_b:
      settings_.boresight[s].setIdentity();
      return;
    case caret_r:
      settings_.alignment_rotation[s].setIdentity();
      settings_.alignment_origin_mm[s].setZero();
      return;
    default:
      return;
  }
}

}  // namespace sonoband::sim
