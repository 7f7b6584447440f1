#include "hal/tracker/liberty_records.h"

#include <cmath>
#include <numbers>

#include "hal/tracker/little_endian.h"

namespace sonoband::liberty {
namespace {

Eigen::Vector3d load_vector(const std::uint8_t* p) {
  return {wire::load_f32(p), wire::load_f32(p + 4), wire::load_f32(p + 8)};
}

double mm_per(Units units) {
  return units == Units::centimetres ? 10.0 : 25.4;
}

}  // namespace

std::optional<Record> decode_record(const Packet& packet, const OutputList& list, Units units) {
  if (packet.body.size() != list.body_bytes()) return std::nullopt;
  Record r;
  r.station = packet.station;
  r.error = packet.error;
  const std::uint8_t* p = packet.body.data();
  for (const std::uint8_t code : list.items()) {
    switch (static_cast<Item>(code)) {
      case Item::space:
      case Item::crlf:
        break;
      case Item::position:
      case Item::position_extended:
        r.position_mm = mm_per(units) * load_vector(p);
        break;
      case Item::angles:
      case Item::angles_extended:
        r.angles_deg = load_vector(p);
        break;
      case Item::quaternion:
        r.quaternion_wxyz = Eigen::Vector4d(wire::load_f32(p), wire::load_f32(p + 4), wire::load_f32(p + 8),
                                            wire::load_f32(p + 12));
        break;
      case Item::time_ms:
        r.time_ms = wire::load_u32(p);
        break;
      case Item::frame_count:
        r.frame = wire::load_u32(p);
        break;
      case Item::stylus:
        r.stylus = wire::load_i32(p);
        break;
      case Item::distortion:
        r.distortion = wire::load_i32(p);
        break;
      case Item::sync:
        r.sync = wire::load_i32(p);
        break;
      default:
        return std::nullopt;
    }
    p += binary_size(code);
  }
  return r;
}

Eigen::Quaterniond quaternion_from_angles(const Eigen::Vector3d& angles_deg) {
  const Eigen::Vector3d a = angles_deg * (std::numbers::pi / 180);
  return Eigen::AngleAxisd(a[0], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(a[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(a[2], Eigen::Vector3d::UnitX());
}

ValueFault check_values(const Record& r) {
  constexpr double farthest_mm = 5000;
  constexpr double norm_tolerance = 0.01;
  if (r.position_mm) {
    if (!r.position_mm->allFinite()) return ValueFault::not_finite;
    if (r.position_mm->cwiseAbs().maxCoeff() > farthest_mm) return ValueFault::too_far;
  }
  if (r.angles_deg && !r.angles_deg->allFinite()) return ValueFault::not_finite;
  if (r.quaternion_wxyz) {
    if (!r.quaternion_wxyz->allFinite()) return ValueFault::not_finite;
    if (std::abs(r.quaternion_wxyz->norm() - 1) > norm_tolerance) return ValueFault::bad_quaternion;
  }
  if (r.distortion && (*r.distortion < 0 || *r.distortion > 2)) return ValueFault::bad_distortion;
  return ValueFault::none;
}

std::optional<std::int32_t> decode_number(const Packet& packet) {
  if (packet.body.size() != 4) return std::nullopt;
  return wire::load_i32(packet.body.data());
}

std::optional<std::array<float, 4>> decode_filter(const Packet& packet) {
  if (packet.body.size() != 16) return std::nullopt;
  std::array<float, 4> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = wire::load_f32(packet.body.data() + 4 * i);
  return v;
}

std::optional<std::array<float, 3>> decode_vector(const Packet& packet) {
  if (packet.body.size() != 12) return std::nullopt;
  std::array<float, 3> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = wire::load_f32(packet.body.data() + 4 * i);
  return v;
}

std::optional<OutputList> decode_output_list(const Packet& packet) {
  if (packet.body.size() % 4 != 0) return std::nullopt;
  OutputList list;
  for (std::size_t at = 0; at < packet.body.size(); at += 4) {
    const std::int32_t code = wire::load_i32(packet.body.data() + at);
    if (code == -1) return list;
    if (code < 0 || code > 12 || list.count == OutputList::capacity) return std::nullopt;
    list.codes[static_cast<std::size_t>(list.count++)] = static_cast<std::uint8_t>(code);
  }
  // A list of 20 fills the body and may come without its terminator.
  if (list.count == OutputList::capacity) return list;
  return std::nullopt;
}

std::optional<StationMap> decode_stations(const Packet& packet) {
  if (packet.body.size() != 4) return std::nullopt;
  return StationMap{wire::load_u16(packet.body.data()), wire::load_u16(packet.body.data() + 2)};
}

std::optional<Identity> decode_identity(const Packet& packet) {
  constexpr std::size_t text_at = 3;  // after the station count, the type and a reserved byte
  if (packet.body.size() < text_at) return std::nullopt;
  Identity identity;
  identity.tag = packet.tag;
  identity.stations = packet.body[0];
  std::size_t n = 0;
  for (const std::uint8_t c : packet.body.subspan(text_at)) {
    if (n + 1 == identity.text.size() || (n > 0 && (c == '\r' || c == '\n' || c == 0))) break;
    if (c >= 0x20 && c < 0x7f) identity.text[n++] = static_cast<char>(c);
  }
  return identity;
}

}  // namespace sonoband::liberty
