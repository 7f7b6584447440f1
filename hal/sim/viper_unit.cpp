#include "hal/sim/viper_unit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/sim/liberty_noise.h"
#include "hal/sim/random.h"
#include "hal/tracker/little_endian.h"

namespace sonoband::sim {
namespace {

constexpr Duration latency = std::chrono::milliseconds(1);
constexpr double radians = M_PI / 180;
constexpr std::uint32_t set = 0, get = 1, reset = 2, ack = 3, nak = 4;
constexpr std::uint32_t general_failure = 0, bad_command = 2;
constexpr std::array<double, 6> rates_hz{30, 60, 120, 240, 480, 960};
constexpr std::array<double, 4> unit_mm{25.4, 304.8, 10, 1000};
constexpr std::size_t longest_command = 256;

// Bit by bit, as the description has it.
std::uint32_t checksum(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool odd = ((crc ^ static_cast<std::uint32_t>(byte >> bit)) & 1) != 0;
      crc = crc >> 1 ^ (odd ? 0xa001U : 0U);
    }
  return crc;
}

bool one_record_only(FaultKind kind) {
  return kind == FaultKind::garbage || kind == FaultKind::dropped_byte || kind == FaultKind::flipped_size ||
         kind == FaultKind::not_finite || kind == FaultKind::zero_quaternion ||
         kind == FaultKind::duplicate_record || kind == FaultKind::displaced;
}

}  // namespace

ViperUnit::ViperUnit(const ViperUnitConfig& config, ProbePose pose, Sink sink, Stamp now)
    : config_(config), pose_(std::move(pose)), sink_(std::move(sink)), now_(now), began_(now) {
  heard_.reserve(4 * longest_command);
  settings_.continuous = config.streams_at_start;
}

Duration ViperUnit::period() const {
  return from_seconds(1 / rates_hz[settings_.rate]);
}

Stamp ViperUnit::time_of(std::uint64_t tick) const {
  const double ns = static_cast<double>(tick) * 1e9 / rates_hz[settings_.rate];
  return began_ + Duration(std::llround(ns * (1 + config_.clock_drift_ppm * 1e-6)));
}

void ViperUnit::power_cycle(Stamp now) {
  settings_ = Settings();
  heard_.clear();
  frame_ = 0;
  hung_ = false;
  deaf_until_ = now;
  began_ = now;
  ticks_ = 0;
}

void ViperUnit::usb_reset() {
  hung_ = false;
  heard_.clear();
}

double ViperUnit::gauss() {
  return gaussian(config_.seed, random_++);
}

void ViperUnit::advance(Stamp now) {
  if (deaf_until_ > now_ && now >= deaf_until_) power_cycle(deaf_until_);
  now_ = std::max(now_, now);
  while (time_of(ticks_ + 1) + latency <= now) {
    const Stamp reading = time_of(++ticks_);
    ++frame_;
    const Stamp sent = reading + latency;
    if (!settings_.continuous || hung_ || sent < deaf_until_) continue;
    if (missing_ > 0)
      --missing_;
    else
      send_poses(reading, sent);
  }
}

Stamp ViperUnit::next_send(Stamp now) const {
  return now < deaf_until_ ? deaf_until_ : time_of(ticks_ + 1) + latency;
}

bool ViperUnit::has(FaultKind kind, Stamp t) const {
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& f) {
    return f.kind == kind && f.lasts > Duration(0) && f.at <= t && t < f.at + f.lasts;
  });
}

bool ViperUnit::once(FaultKind kind, double& value) {
  for (Fault& f : faults_)
    if (f.kind == kind && f.lasts < Duration(0)) {
      value = f.value;
      f.lasts = Duration(0);
      return true;
    }
  return false;
}

void ViperUnit::inject(const Fault& f) {
  switch (f.kind) {
    case FaultKind::missing_records:
      missing_ = static_cast<int>(f.value);
      return;
    case FaultKind::ignored_starts:
      ignored_starts_ = static_cast<int>(f.value);
      return;
    case FaultKind::counters_back:
      frame_ -= static_cast<std::uint32_t>(f.value);
      return;
    case FaultKind::counters_near_wrap:
      frame_ = 0U - static_cast<std::uint32_t>(f.value);
      return;
    case FaultKind::stream_stops:
      settings_.continuous = false;
      return;
    case FaultKind::settings_lost: {
      const bool streams = settings_.continuous;
      settings_ = Settings();
      settings_.continuous = streams;
      return;
    }
    case FaultKind::deaf_until_reset:
      hung_ = true;
      return;
    case FaultKind::deaf:
      deaf_until_ = std::max(deaf_until_, f.at + f.lasts);
      return;
    default:
      faults_[fault_] = f;
      if (one_record_only(f.kind)) faults_[fault_].lasts = Duration(-1);
      fault_ = (fault_ + 1) % faults_.size();
      return;
  }
}

void ViperUnit::receive(std::span<const std::uint8_t> bytes, Stamp now) {
  advance(now);
  if (hung_ || now < deaf_until_) return;
  heard_.insert(
      heard_.end(), bytes.begin(),
      bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), heard_.capacity() - heard_.size())));
  while (heard_.size() >= 8) {
    const std::size_t size = wire::load_u32(heard_.data() + 4);
    const bool framed = heard_[0] == 'V' && heard_[1] == 'P' && heard_[2] == 'R' && heard_[3] == 'C' &&
                        size >= 24 && size <= longest_command;
    if (!framed) {
      heard_.erase(heard_.begin());
      continue;
    }
    if (heard_.size() < 8 + size) return;
    const std::span<const std::uint8_t> frame(heard_.data(), 8 + size);
    if (checksum(frame.first(4 + size)) == wire::load_u32(frame.data() + 4 + size))
      execute(frame.subspan(8, size - 4), now);
    heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(8 + size));
  }
}

void ViperUnit::send(const WireBytes& body, char kind, int record_station, Stamp t) {
  WireBytes out;
  out.text("VPR");
  out.byte(static_cast<std::uint8_t>(kind));
  out.u32(static_cast<std::uint32_t>(body.size + 4));
  for (const std::uint8_t b : body.view()) out.byte(b);
  out.u32(checksum(out.view()));

  double value = 0;
  if (record_station != 0) {
    if (once(FaultKind::garbage, value)) {
      WireBytes junk;
      for (int i = 0; i < static_cast<int>(value); ++i)
        junk.byte(i % 7 == 3 ? std::uint8_t{'V'}
                             : static_cast<std::uint8_t>(256 * uniform(config_.seed, random_++)));
      sink_(t, junk.view(), 0);
    }
    if (once(FaultKind::flipped_size, value)) {
      const std::size_t bit = static_cast<std::size_t>(value) % 32;
      out.data[4 + bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    }
    if (once(FaultKind::dropped_byte, value)) {
      const auto at = out.data.begin() +
                      static_cast<std::ptrdiff_t>(std::min(static_cast<std::size_t>(value), out.size - 1));
      std::copy(at + 1, out.data.begin() + static_cast<std::ptrdiff_t>(out.size), at);
      --out.size;
    }
    if (once(FaultKind::duplicate_record, value)) sink_(t, out.view(), record_station);
  }
  sink_(t, out.view(), record_station);
}

void ViperUnit::answer(std::uint32_t order, std::uint32_t action, std::span<const std::uint8_t> payload) {
  WireBytes body;
  for (const std::uint32_t v : {0U, order, action, 0U, 0U}) body.u32(v);
  for (const std::uint8_t b : payload) body.byte(b);
  send(body, 'C', 0, now_);
}

void ViperUnit::refuse(std::uint32_t order, std::uint32_t code) {
  std::array<std::uint8_t, 180> payload{};
  wire::store_u32(payload.data(), code);
  answer(order, nak, payload);
}

void ViperUnit::execute(std::span<const std::uint8_t> body, Stamp now) {
  const std::uint32_t order = wire::load_u32(body.data() + 4);
  const std::uint32_t action = wire::load_u32(body.data() + 8);
  const std::span<const std::uint8_t> payload = body.subspan(20);
  std::array<std::uint8_t, 16> value{};
  const auto number = [&](std::uint32_t v) {
    wire::store_u32(value.data(), v);
    return std::span<const std::uint8_t>(value).first(4);
  };
  switch (order) {
    case 0:  // hemisphere
      if (action == set && payload.size() == 16) {
        std::copy(payload.begin(), payload.end(), settings_.hemisphere.begin());
        return answer(order, ack, {});
      }
      return action == get ? answer(order, ack, settings_.hemisphere) : refuse(order, bad_command);
    case 1:  // filter
      return config_.refuses_filter ? refuse(order, bad_command) : answer(order, ack, {});
    case 2:  // tip offset, increment, boresight, source rotation: back to none
    case 3:
    case 4:
    case 8:
      return action == reset ? answer(order, ack, {}) : refuse(order, bad_command);
    case 6:  // rate
      if (action == get) return answer(order, ack, number(settings_.rate));
      if (action != set || payload.size() != 4 || wire::load_u32(payload.data()) >= rates_hz.size())
        return refuse(order, bad_command);
      settings_.rate = wire::load_u32(payload.data());
      began_ = now;
      ticks_ = 0;
      return answer(order, ack, {});
    case 7:  // units
      if (action == get) {
        wire::store_u32(value.data(), settings_.position_units);
        wire::store_u32(value.data() + 4, settings_.angle_units);
        return answer(order, ack, std::span(value).first(8));
      }
      if (action != set || payload.size() != 8 || wire::load_u32(payload.data()) > 3 ||
          wire::load_u32(payload.data() + 4) > 2)
        return refuse(order, bad_command);
      settings_.position_units = wire::load_u32(payload.data());
      settings_.angle_units = wire::load_u32(payload.data() + 4);
      return answer(order, ack, {});
    case 10: {  // station map
      std::uint32_t map = 1U << 24;
      for (int s = 0; s < config_.sensors; ++s)
        if (s != 0 || !has(FaultKind::station_silent, now)) map |= 1U << s;
      return answer(order, ack, number(map));
    }
    case 19:  // continuous
      if (action == reset) {
        settings_.continuous = false;
        return answer(order, ack, {});
      }
      if (action != set) return refuse(order, bad_command);
      if (ignored_starts_ > 0) {
        --ignored_starts_;
        return;
      }
      if (payload.size() == 4 && wire::load_u32(payload.data()) != 0xffffffff)
        frame_ = wire::load_u32(payload.data());
      settings_.continuous = true;
      return answer(order, ack, {});
    case 20: {  // identity
      static constexpr std::array<std::uint8_t, 16> name{'S', 'i', 'm', 'u', 'l', 'a', 't', 'e',
                                                         'd', ' ', 'V', 'I', 'P', 'E', 'R'};
      return answer(order, ack, name);
    }
    case 21:  // initialise
      answer(order, ack, {});
      settings_.continuous = false;
      deaf_until_ = now + config_.self_test;
      return;
    default:
      return refuse(order, general_failure);
  }
}

void ViperUnit::put_sensor(WireBytes& out, int sensor, Stamp t) {
  Rigid<frame::Tracker, frame::Probe> pose;
  if (sensor == 0)
    pose = pose_(t);
  else
    pose.translation = {300, 40.0 * sensor, 100};
  const TrackerNoise noise = liberty_noise(pose.translation.norm());
  Eigen::Vector3d turn;
  for (int i = 0; i < 3; ++i) {
    pose.translation[i] += config_.noise * noise.position_mm * gauss();
    turn[i] = config_.noise * noise.angle_deg * radians * gauss();
  }
  Eigen::Quaterniond q(pose.rotation);
  const double angle = turn.norm();
  if (angle > 0) q = q * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));

  std::uint32_t distortion = 0;
  if (sensor == 0)
    for (const Fault& f : faults_)
      if (f.kind == FaultKind::distortion && f.at <= t && t < f.at + f.lasts)
        distortion = static_cast<std::uint32_t>(f.value);
  out.u32(static_cast<std::uint32_t>(sensor) | settings_.position_units << 8 | settings_.angle_units << 10 |
          distortion << 14);
  std::array<float, 7> numbers{};
  double value = 0;
  if (sensor == 0 && once(FaultKind::displaced, value)) pose.translation.x() += value;
  for (std::size_t i = 0; i < 3; ++i)
    numbers[i] = static_cast<float>(pose.translation[static_cast<Eigen::Index>(i)] /
                                    unit_mm[settings_.position_units]);
  if (settings_.angle_units == 2) {
    numbers[3] = static_cast<float>(q.w());
    numbers[4] = static_cast<float>(q.x());
    numbers[5] = static_cast<float>(q.y());
    numbers[6] = static_cast<float>(q.z());
  } else {
    const Eigen::Vector3d a = q.toRotationMatrix().eulerAngles(2, 1, 0);
    for (std::size_t i = 0; i < 3; ++i)
      numbers[3 + i] =
          static_cast<float>(a[static_cast<Eigen::Index>(i)] / (settings_.angle_units == 0 ? radians : 1));
  }
  if (sensor == 0 && once(FaultKind::not_finite, value))
    numbers[static_cast<std::size_t>(value) % 7] = std::numeric_limits<float>::quiet_NaN();
  if (sensor == 0 && once(FaultKind::zero_quaternion, value))
    std::fill(numbers.begin() + 3, numbers.end(), 0.0F);
  for (const float v : numbers) out.f32(v);
}

void ViperUnit::send_poses(Stamp reading, Stamp sent) {
  WireBytes body;
  const bool probe_silent = has(FaultKind::station_silent, reading);
  const int first = probe_silent ? 1 : 0;
  for (const std::uint32_t v : {0U, frame_, 0U, static_cast<std::uint32_t>(config_.sensors - first)})
    body.u32(v);
  for (int s = first; s < config_.sensors; ++s) put_sensor(body, s, reading);
  send(body, 'P', 1, sent);
}

}  // namespace sonoband::sim
