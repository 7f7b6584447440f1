// The frames of the Polhemus VIPER. Unlike the LIBERTY's they carry a checksum, commands are answered, and
// every pose frame is counted.
//
// | offset | size | field                                                                       |
// |--------|------|-----------------------------------------------------------------------------|
// | 0      | 4    | "VPRC" (command or reply) or "VPRP" (poses)                                 |
// | 4      | 4    | bytes that follow, little-endian, the checksum included                     |
// | 8      | n    | body                                                                        |
// | 8 + n  | 4    | CRC-16 of all before (polynomial 0x8005 reflected, start 0), zero-extended  |
//
// A command body: unit, command, action, two arguments (u32 each), then its payload. A pose body: unit,
// frame, info, sensor count (u32 each), then 32 bytes per sensor.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/tracker/codec.h"
#include "hal/tracker/wire_command.h"

namespace sonoband::viper {

std::uint16_t crc16(std::span<const std::uint8_t> bytes);

enum class Order : std::uint32_t {
  hemisphere = 0,
  filter = 1,
  tip_offset = 2,
  increment = 3,
  boresight = 4,
  frame_rate = 6,
  units = 7,
  source_rotation = 8,
  station_map = 10,
  single_pose = 18,
  continuous = 19,
  identity = 20,
  initialise = 21,
};

enum class Action : std::uint32_t { set = 0, get = 1, reset = 2, ack = 3, nak = 4, nak_warning = 5 };

constexpr std::uint32_t all_sensors = 0xffffffff;
constexpr std::size_t frame_overhead = 12;  // preamble, size, checksum
constexpr std::size_t order_body = 20;      // without payload
constexpr std::size_t pose_body = 16;       // without sensors
constexpr std::size_t sensor_bytes = 32;
constexpr int max_sensors = 16;
constexpr std::size_t max_size = 1024;  // of the size field; the longest known frame has 532

// A whole frame whose checksum holds.
struct Frame {
  bool poses = false;                  // VPRP
  std::span<const std::uint8_t> body;  // lives in the parser until its next push
  Stamp arrived{};                     // when the read that completed it returned
};

struct Reply {
  Order order{};
  Action action{};
  std::span<const std::uint8_t> payload;
};
std::optional<Reply> decode_reply(const Frame& frame);  // empty for a pose frame or a body that is too short

enum class PositionUnits : std::uint32_t { inch = 0, foot = 1, centimetre = 2, metre = 3 };
enum class AngleUnits : std::uint32_t { degrees = 0, radians = 1, quaternion = 2 };

struct SensorPose {
  int sensor = 0;  // 0-based
  bool is_virtual = false;
  PositionUnits position_units{};
  AngleUnits angle_units{};
  std::uint8_t distortion = 0;  // 0 to 255
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion_wxyz = Eigen::Vector4d::Zero();  // as sent; means something in that unit only
};

struct PoseHeader {
  std::uint32_t frame = 0;
  std::uint8_t self_test_error = 0;  // 4 bits
  int sensors = 0;
};
// Empty unless the body's size is exactly that of its sensor count and there are at most 16.
std::optional<PoseHeader> decode_pose_header(const Frame& frame);
SensorPose decode_sensor(const Frame& frame, int index);  // index below the header's sensor count

// A command frame; the payload has at most 20 bytes.
WireCommand make_order(Order order, Action action, std::uint32_t arg1 = 0, std::uint32_t arg2 = 0,
                       std::span<const std::uint8_t> payload = {});

// Bytes to frames. A frame counts when preamble, size and checksum hold; whatever does not costs one byte,
// not the buffer.
class Parser {
 public:
  static constexpr std::size_t capacity = 8192;

  void reset() { begin_ = end_ = 0, resync_ = false; }
  // Takes as many of `bytes` as fit and says how many; all of them do if next() was called until it had no
  // more and there are at most `capacity` - 1100.
  std::size_t push(std::span<const std::uint8_t> bytes, Stamp now);
  // The next whole frame. Call until false after each push, and once after each read that brought nothing: a
  // frame that stays incomplete for longer than `patience` is thrown away.
  bool next(Frame& out, Stamp now, Duration patience);
  const WireCounters& counters() const { return counters_; }
  // Counts a whole frame, last handed out, as one that is of no use.
  void disown(const Frame& frame) { counters_.resync_bytes += frame.body.size() + frame_overhead; }

 private:
  enum class Judgement : std::uint8_t { good, bad, incomplete };
  Judgement judge() const;
  std::size_t held() const { return end_ - begin_; }
  void drop(std::size_t bytes);

  std::array<std::uint8_t, capacity> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  Stamp last_push_{};
  bool resync_ = false;
  WireCounters counters_;
};

}  // namespace sonoband::viper
