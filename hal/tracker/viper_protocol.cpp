#include "hal/tracker/viper_protocol.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "hal/tracker/little_endian.h"

namespace sonoband::viper {
namespace {

constexpr std::array<std::uint8_t, 4> order_preamble{'V', 'P', 'R', 'C'};
constexpr std::array<std::uint8_t, 4> pose_preamble{'V', 'P', 'R', 'P'};
constexpr std::size_t checksum_bytes = 4;

constexpr std::array<std::uint16_t, 256> crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xa001 : crc >> 1;
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

double mm_per(PositionUnits units) {
  switch (units) {
    case PositionUnits::inch:
      return 25.4;
    case PositionUnits::foot:
      return 304.8;
    case PositionUnits::centimetre:
      return 10;
    case PositionUnits::metre:
      return 1000;
  }
  return 0;
}

// What a body of this size can be: known before the rest has come, so that a damaged size does not make the
// parser wait for bytes that never come.
bool possible_size(bool poses, std::size_t size) {
  if (size <= checksum_bytes || size > max_size) return false;
  const std::size_t body = size - checksum_bytes;
  if (!poses) return body >= order_body;
  return body >= pose_body && (body - pose_body) % sensor_bytes == 0 &&
         (body - pose_body) / sensor_bytes <= static_cast<std::size_t>(max_sensors);
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  static constexpr auto table = crc_table();
  unsigned crc = 0;
  for (const std::uint8_t b : bytes) crc = crc >> 8 ^ table[(crc ^ b) & 0xff];
  return static_cast<std::uint16_t>(crc);
}

std::optional<Reply> decode_reply(const Frame& frame) {
  if (frame.poses || frame.body.size() < order_body) return std::nullopt;
  return Reply{.order = static_cast<Order>(wire::load_u32(frame.body.data() + 4)),
               .action = static_cast<Action>(wire::load_u32(frame.body.data() + 8)),
               .payload = frame.body.subspan(order_body)};
}

std::optional<PoseHeader> decode_pose_header(const Frame& frame) {
  if (!frame.poses || frame.body.size() < pose_body) return std::nullopt;
  const std::uint8_t* p = frame.body.data();
  const std::uint32_t sensors = wire::load_u32(p + 12);
  if (sensors > static_cast<std::uint32_t>(max_sensors) ||
      frame.body.size() != pose_body + sensor_bytes * sensors)
    return std::nullopt;
  return PoseHeader{.frame = wire::load_u32(p + 4),
                    .self_test_error = static_cast<std::uint8_t>(wire::load_u32(p + 8) >> 4 & 0xf),
                    .sensors = static_cast<int>(sensors)};
}

SensorPose decode_sensor(const Frame& frame, int index) {
  const std::uint8_t* p = frame.body.data() + pose_body + sensor_bytes * static_cast<std::size_t>(index);
  assert(p + sensor_bytes <= frame.body.data() + frame.body.size());
  const std::uint32_t flags = wire::load_u32(p);
  SensorPose out;
  out.sensor = static_cast<int>(flags & 0x7f);
  out.is_virtual = (flags >> 7 & 1) != 0;
  out.position_units = static_cast<PositionUnits>(flags >> 8 & 3);
  out.angle_units = static_cast<AngleUnits>(flags >> 10 & 3);
  out.distortion = static_cast<std::uint8_t>(flags >> 14 & 0xff);
  for (int i = 0; i < 3; ++i) out.position_mm[i] = mm_per(out.position_units) * wire::load_f32(p + 4 + 4 * i);
  for (int i = 0; i < 4; ++i) out.quaternion_wxyz[i] = wire::load_f32(p + 16 + 4 * i);
  return out;
}

WireCommand make_order(Order order, Action action, std::uint32_t arg1, std::uint32_t arg2,
                       std::span<const std::uint8_t> payload) {
  WireCommand c;
  const std::size_t body = order_body + payload.size();
  assert(body + frame_overhead <= c.storage.size());
  std::uint8_t* p = c.storage.data();
  std::copy(order_preamble.begin(), order_preamble.end(), p);
  wire::store_u32(p + 4, static_cast<std::uint32_t>(body + checksum_bytes));
  wire::store_u32(p + 8, 0);
  wire::store_u32(p + 12, static_cast<std::uint32_t>(order));
  wire::store_u32(p + 16, static_cast<std::uint32_t>(action));
  wire::store_u32(p + 20, arg1);
  wire::store_u32(p + 24, arg2);
  std::copy(payload.begin(), payload.end(), p + 28);
  wire::store_u32(p + 8 + body, crc16({p, 8 + body}));
  c.size = body + frame_overhead;
  return c;
}

std::size_t Parser::push(std::span<const std::uint8_t> bytes, Stamp now) {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, held());
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t n = std::min(bytes.size(), capacity - end_);
  if (n > 0) {
    std::memcpy(buffer_.data() + end_, bytes.data(), n);
    end_ += n;
    last_push_ = now;
  }
  return n;
}

Parser::Judgement Parser::judge() const {
  const std::span<const std::uint8_t> b(buffer_.data() + begin_, held());
  const std::size_t known = std::min<std::size_t>(b.size(), 4);
  const bool order =
      std::equal(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(known), order_preamble.begin());
  const bool poses =
      std::equal(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(known), pose_preamble.begin());
  if (!order && !poses) return Judgement::bad;
  if (b.size() < 8) return Judgement::incomplete;
  const std::size_t size = wire::load_u32(b.data() + 4);
  if (!possible_size(poses, size)) return Judgement::bad;
  if (b.size() < 8 + size) return Judgement::incomplete;
  const std::size_t covered = 8 + size - checksum_bytes;
  return crc16(b.first(covered)) == wire::load_u32(b.data() + covered) ? Judgement::good : Judgement::bad;
}

void Parser::drop(std::size_t bytes) {
  if (!resync_) ++counters_.resync_events;
  resync_ = true;
  counters_.resync_bytes += bytes;
  begin_ += bytes;
}

bool Parser::next(Frame& out, Stamp now, Duration patience) {
  while (held() > 0) {
    switch (judge()) {
      case Judgement::bad:
        drop(1);
        break;
      case Judgement::incomplete:
        if (now - last_push_ <= patience) return false;
        // Its beginning was damaged, or its rest is lost; a whole frame may hide behind it.
        ++counters_.truncated;
        drop(1);
        break;
      case Judgement::good: {
        const std::uint8_t* p = buffer_.data() + begin_;
        const std::size_t size = wire::load_u32(p + 4);
        out = {.poses = p[3] == 'P', .body = {p + 8, size - checksum_bytes}, .arrived = last_push_};
        begin_ += 8 + size;
        resync_ = false;
        ++counters_.frames;
        return true;
      }
    }
  }
  return false;
}

}  // namespace sonoband::viper
