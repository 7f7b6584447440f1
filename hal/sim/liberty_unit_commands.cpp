// The unit's side of the conversation.
#include <algorithm>
#include <cctype>
#include <string_view>

#include "hal/sim/liberty_unit.h"
#include "hal/tracker/liberty_commands.h"
#include "hal/tracker/liberty_records.h"

namespace sonoband::sim {

using liberty::control;
using liberty::OutputList;
using liberty::Tag;

namespace {

constexpr std::uint8_t invalid_command = 0x01;
constexpr std::uint8_t invalid_station = 0x02;
constexpr std::uint8_t invalid_parameter = 0x03;
constexpr std::uint8_t too_few = 0x04;
constexpr std::uint8_t too_many = 0x05;
constexpr std::uint8_t below_limit = 0x06;
constexpr std::uint8_t above_limit = 0x07;
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

void LibertyUnit::set_number(const CommandLine& c, int& setting, int least, int most) {
  if (c.count == 0) return reply_i32(0, c.command, setting);
  if (c.count > 1) return error(too_many, c.command);
  const int v = c.integer(0).value_or(setting);
  if (v < least) return error(below_limit, c.command);
  if (v > most) return error(above_limit, c.command);
  setting = v;
}

void LibertyUnit::set_switch(const CommandLine& c, bool& setting) {
  int v = setting ? 1 : 0;
  set_number(c, v, 0, 1);
  setting = v == 1;
}

void LibertyUnit::set_vector(const CommandLine& c, int station, LibertySettings::PerStation& setting,
                             int most) {
  auto& v = setting[static_cast<std::size_t>(station - 1)];
  if (c.count == 1) return reply_f32(station, c.command, v);
  if (c.count > 1 + most) return error(too_many, c.command);
  for (int i = 1; i < c.count; ++i)
    if (const auto given = c.arguments[static_cast<std::size_t>(i)])
      v[static_cast<std::size_t>(i - 1)] = static_cast<float>(*given);
}

void LibertyUnit::set_filter(const CommandLine& c, std::array<float, 4>& setting) {
  if (c.count == 0) return reply_f32(0, c.command, setting);
  if (c.count > 4) return error(too_many, c.command);
  for (int i = 0; i < c.count; ++i) {
    const auto given = c.arguments[static_cast<std::size_t>(i)];
    if (!given) continue;
    if (*given < 0) return error(below_limit, c.command);
    if (*given > 1) return error(above_limit, c.command);
    setting[static_cast<std::size_t>(i)] = static_cast<float>(*given);
  }
}

void LibertyUnit::set_output_list(const CommandLine& c, int station) {
  if (c.count == 1) return reply_output_list(station);
  if (c.count - 1 > OutputList::capacity) return error(too_many, c.command);
  OutputList list;
  for (int i = 1; i < c.count; ++i) {
    const int code = c.integer(i).value_or(-1);
    if (code < 0 || code > 12 || liberty::binary_size(static_cast<std::uint8_t>(code)) == 0)
      return error(invalid_parameter, c.command);
    list.codes[static_cast<std::size_t>(list.count++)] = static_cast<std::uint8_t>(code);
  }
  settings_.lists[static_cast<std::size_t>(station - 1)] = list;
}

void LibertyUnit::set_stations(const CommandLine& c) {
  const int station = c.integer(0).value_or(0);
  if (station == 0) return reply_stations();
  if (station < 1 || station > stations()) return error(invalid_station, c.command);
  const auto bit = static_cast<std::uint16_t>(1U << (station - 1));
  if (c.integer(1).value_or(1) != 0)
    settings_.active = static_cast<std::uint16_t>(settings_.active | bit);
  else
    settings_.active = static_cast<std::uint16_t>(settings_.active & ~bit);
}

// Origin, a point on the new x axis and one towards the new y axis, in the frame that holds now.
void LibertyUnit::set_alignment(const CommandLine& c, int station) {
  if (c.count < 10) return error(too_few, c.command);
  const auto s = static_cast<std::size_t>(station - 1);
  const double mm_per_unit = settings_.centimetres ? 10 : 25.4;
  std::array<Eigen::Vector3d, 3> points;
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t i = 0; i < 3; ++i)
      points[p][static_cast<Eigen::Index>(i)] = mm_per_unit * c.arguments[1 + 3 * p + i].value_or(0);
  const Eigen::Vector3d x = (points[1] - points[0]).normalized();
  const Eigen::Vector3d z = x.cross(points[2] - points[0]).normalized();
  if (!z.allFinite() || z.norm() < 0.5) return error(invalid_parameter, c.command);
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  settings_.alignment_origin_mm[s] += settings_.alignment_rotation[s] * points[0];
  settings_.alignment_rotation[s] = settings_.alignment_rotation[s] * axes;
}

void LibertyUnit::set_boresight(const CommandLine& c, int station, Stamp now) {
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    if (1 + i < c.count) angles[i] = c.arguments[1 + static_cast<std::size_t>(i)].value_or(0);
  const Eigen::Matrix3d reads = liberty::quaternion_from_angles(angles).toRotationMatrix();
  settings_.boresight[static_cast<std::size_t>(station - 1)] =
      sensor_pose(station, now).rotation.transpose() * reads;
}

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
