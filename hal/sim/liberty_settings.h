// What a LIBERTY or PATRIOT can be set to, as it is when nobody has set anything.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "hal/tracker/liberty_protocol.h"

namespace sonoband::sim {

struct LibertySettings {
  using PerStation = std::array<std::array<float, 3>, liberty::max_stations>;

  bool continuous = false;  // the stored set includes it: a unit may power up streaming
  bool binary = false;
  bool centimetres = false;
  std::array<liberty::OutputList, liberty::max_stations> lists;
  int rate = 4;  // 3: 120 Hz, 4: 240 Hz
  int sync = 0;
  int compensation_map = 0;
  bool echo = false;
  bool buffering = true;
  std::uint16_t active = 0xffff;
  std::array<float, 4> position_filter{0.2F, 0.2F, 0.8F, 0.95F};
  std::array<float, 4> attitude_filter{0.2F, 0.2F, 0.8F, 0.95F};
  std::array<float, 3> mounting_deg{};
  PerStation hemisphere;
  PerStation tip_offset{};  // in the units of then
  // Pose of the user's frame in the source's: rotations and offsets pile up until cleared.
  std::array<Eigen::Matrix3d, liberty::max_stations> alignment_rotation;
  std::array<Eigen::Vector3d, liberty::max_stations> alignment_origin_mm;
  std::array<Eigen::Matrix3d, liberty::max_stations> boresight;  // turns the sensor's axes
  std::array<int, liberty::max_stations> stylus_mode{};

  LibertySettings() {
    lists.fill({liberty::Item::position, liberty::Item::angles, liberty::Item::crlf});
    hemisphere.fill({1, 0, 0});
    boresight.fill(Eigen::Matrix3d::Identity());
    alignment_rotation.fill(Eigen::Matrix3d::Identity());
    alignment_origin_mm.fill(Eigen::Vector3d::Zero());
  }
};

}  // namespace sonoband::sim
