// What a command with values sets, checked; without values it asks for the present ones.
#include "hal/sim/liberty_unit.h"
#include "hal/tracker/liberty_records.h"

namespace sonoband::sim {

using liberty::OutputList;

namespace {

constexpr std::uint8_t invalid_station = 0x02;
constexpr std::uint8_t invalid_parameter = 0x03;
constexpr std::uint8_t too_few = 0x04;
constexpr std::uint8_t too_many = 0x05;
constexpr std::uint8_t below_limit = 0x06;
constexpr std::uint8_t above_limit = 0x07;

}  // namespace

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

}  // namespace sonoband::sim
