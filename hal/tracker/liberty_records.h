// What is inside the frames: pose records and the answers to questions.
//
// The source's frame has +X forward, +Y right, +Z down (right-handed). Azimuth turns about Z, then elevation
// about Y, then roll about X; the matrix maps sensor coordinates into the source's. Quaternions are scalar
// first and mean the same rotation. That is `tracker_from_probe`, once positions are in mm.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/tracker/liberty_protocol.h"

namespace sonoband::liberty {

enum class Units : std::uint8_t { inches = 0, centimetres = 1 };

struct Record {
  std::uint8_t station = 0;
  std::uint8_t error = 0;
  std::optional<Eigen::Vector3d> position_mm;
  std::optional<Eigen::Vector4d> quaternion_wxyz;  // as sent: neither normalised nor of a settled sign
  std::optional<Eigen::Vector3d> angles_deg;       // azimuth, elevation, roll
  std::optional<std::uint32_t> time_ms;
  std::optional<std::uint32_t> frame;
  std::optional<std::int32_t> stylus;
  std::optional<std::int32_t> distortion;
  std::optional<std::int32_t> sync;
};

// Empty if the body's size is not that of the list or the list holds an unknown code.
std::optional<Record> decode_record(const Packet& packet, const OutputList& list, Units units);

// Rotation from sensor to source for azimuth, elevation and roll in degrees.
Eigen::Quaterniond quaternion_from_angles(const Eigen::Vector3d& angles_deg);

enum class ValueFault : std::uint8_t {
  none,
  not_finite,
  too_far,         // a coordinate beyond 5 m: no such reading exists
  bad_quaternion,  // norm off 1 by more than 0.01
  bad_distortion,  // not 0, 1 or 2
};

// With no checksum on the wire, these ranges are what tells a damaged record from a good one.
ValueFault check_values(const Record& record);

// Answers to questions; empty where the body has not the documented shape.
std::optional<std::int32_t> decode_number(const Packet& packet);          // F U R Z @B ^E
std::optional<std::array<float, 4>> decode_filter(const Packet& packet);  // X Y
std::optional<std::array<float, 3>> decode_vector(const Packet& packet);  // H G B N
std::optional<OutputList> decode_output_list(const Packet& packet);       // O

struct StationMap {
  std::uint16_t detected = 0;  // bit s - 1 is station s
  std::uint16_t active = 0;
  bool usable(int station) const { return ((detected & active) >> (station - 1) & 1) != 0; }
};
std::optional<StationMap> decode_stations(const Packet& packet);

struct Identity {
  Tag tag{};
  int stations = 0;
  std::array<char, 64> text{};  // first line, ends in 0
};
std::optional<Identity> decode_identity(const Packet& packet);

}  // namespace sonoband::liberty
