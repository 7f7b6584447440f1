#include "hal/sim/liberty_unit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "hal/sim/liberty_noise.h"
#include "hal/sim/random.h"

namespace sonoband::sim {

using liberty::Item;
using liberty::OutputList;
using liberty::Tag;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

}  // namespace

LibertyUnit::LibertyUnit(const LibertyUnitConfig& config, ProbePose pose, Sink sink, Stamp now)
    : config_(config), pose_(std::move(pose)), sink_(std::move(sink)), settings_(config.start_up), now_(now) {
  stored_[1] = config.start_up;
  start_up_slot_ = 1;
  restart_ticks(now);
}

Tag LibertyUnit::tag() const {
  return config_.model == TrackerModel::patriot ? Tag::patriot : Tag::liberty;
}

Duration LibertyUnit::period() const {
  if (config_.model == TrackerModel::patriot) return from_seconds(1.0 / 60);
  return from_seconds(settings_.rate == 3 ? 1.0 / 120 : 1.0 / 240);
}

Duration LibertyUnit::latency() const {
  return std::chrono::microseconds(config_.model == TrackerModel::patriot ? 18000 : 3500);
}

double LibertyUnit::uniform() {
  return sim::uniform(config_.seed, random_++);
}

double LibertyUnit::gauss() {
  return sim::gaussian(config_.seed, random_++);
}

void LibertyUnit::restart_ticks(Stamp now) {
  ticks_began_ = now;
  ticks_ = 0;
}

Stamp LibertyUnit::time_of(std::uint64_t tick) const {
  const double ns = static_cast<double>(tick) * static_cast<double>(period().count());
  return ticks_began_ + Duration(std::llround(ns * (1 + config_.clock_drift_ppm * 1e-6)));
}

void LibertyUnit::power_cycle(Stamp now) {
  settings_ = stored_[static_cast<std::size_t>(start_up_slot_)];
  frame_ = 0;
  time_ms_ = 0;
  line_size_ = 0;
  deaf_ = Deaf::no;
  deaf_until_ = now;
  now_ = now;
  restart_ticks(now);
}

void LibertyUnit::advance(Stamp now) {
  if (deaf_until_ > now_ && now >= deaf_until_) power_cycle(deaf_until_);
  now_ = std::max(now_, now);
  while (time_of(ticks_ + 1) + latency() <= now) {
    const Stamp reading = time_of(++ticks_);
    ++frame_;
    time_ms_ += 1000 * seconds(period());
    const Stamp sent = reading + latency();
    if (settings_.continuous && !silent(sent)) send_frame(reading, sent, 'C');
  }
}

Stamp LibertyUnit::next_send(Stamp now) const {
  if (now < deaf_until_) return deaf_until_;
  return time_of(ticks_ + 1) + latency();
}

bool LibertyUnit::connected(int station, Stamp t) const {
  return station <= config_.sensors && t >= unplugged_until_[static_cast<std::size_t>(station - 1)];
}

void LibertyUnit::send_frame(Stamp reading, Stamp sent, std::uint8_t command) {
  if (missing_ > 0) {
    --missing_;
    return;
  }
  for (int s = 1; s <= stations(); ++s)
    if (connected(s, reading) && (settings_.active >> (s - 1) & 1) != 0)
      send_record(reading, sent, s, command);
}

Rigid<frame::Tracker, frame::Probe> LibertyUnit::sensor_pose(int station, Stamp t) const {
  Rigid<frame::Tracker, frame::Probe> p;
  if (station == 1)
    p = pose_(t);
  else
    p.translation = {300, 40.0 * station, 100};
  const auto s = static_cast<std::size_t>(station - 1);
  const Eigen::Matrix3d user_from_source = settings_.alignment_rotation[s].transpose();
  p.translation = user_from_source * (p.translation - settings_.alignment_origin_mm[s]);
  p.rotation = user_from_source * p.rotation;
  return p;
}

WireReading LibertyUnit::reading_of(int station, Stamp t) {
  const auto s = static_cast<std::size_t>(station - 1);
  Rigid<frame::Tracker, frame::Probe> pose = sensor_pose(station, t);

  const TrackerNoise noise = liberty_noise(pose.translation.norm());
  Eigen::Vector3d jitter;
  Eigen::Vector3d turn;
  for (int i = 0; i < 3; ++i) {
    jitter[i] = config_.noise * noise.position_mm * gauss();
    turn[i] = config_.noise * noise.angle_deg / degrees * gauss();
  }
  const double angle = turn.norm();
  if (angle > 0) pose.rotation = pose.rotation * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  pose.translation += jitter;

  const double mm_per_unit = settings_.centimetres ? 10 : 25.4;
  Eigen::Vector3d position = pose.translation / mm_per_unit;
  for (int i = 0; i < 3; ++i)
    position += settings_.tip_offset[s][static_cast<std::size_t>(i)] * pose.rotation.col(i);
  // The field is the same at p and -p: the unit reports whichever is in the hemisphere set.
  const Eigen::Vector3f facing(settings_.hemisphere[s].data());
  if (!facing.isZero() && position.dot(facing.cast<double>()) < 0) position = -position;

  const Eigen::Matrix3d turned = pose.rotation * settings_.boresight[s];
  Eigen::Quaterniond q(turned);
  if (q.w() < 0) q.coeffs() *= -1;

  WireReading r;
  for (std::size_t i = 0; i < 3; ++i)
    r.position[i] = static_cast<float>(position[static_cast<Eigen::Index>(i)]);
  r.angles_deg = {static_cast<float>(std::atan2(turned(1, 0), turned(0, 0)) * degrees),
                  static_cast<float>(std::asin(std::clamp(-turned(2, 0), -1.0, 1.0)) * degrees),
                  static_cast<float>(std::atan2(turned(2, 1), turned(2, 2)) * degrees)};
  r.quaternion = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                  static_cast<float>(q.z())};
  r.time_ms = static_cast<std::uint32_t>(std::llround(time_ms_));
  r.frame = frame_;
  return r;
}

void LibertyUnit::damage_reading(WireReading& r, int station, Stamp t) const {
  if (station == 1) {
    if (negated_.at(t))
      for (float& v : r.quaternion) v = -v;
    if (mirrored_.at(t))
      for (float& v : r.position) v = -v;
    if (distortion_.at(t)) r.distortion = static_cast<std::int32_t>(distortion_.value);
  }
  for (std::size_t i = 0; i < once_count_; ++i) {
    const Fault& f = once_[i];
    if (f.station != station) continue;
    // A jump of the count may be negative; then no coordinate is meant.
    const auto at = static_cast<std::size_t>(std::clamp(f.value, 0.0, 6.0));
    float& chosen = at < 3 ? r.position[at] : r.quaternion[std::min<std::size_t>(at - 3, 3)];
    switch (f.kind) {
      case FaultKind::not_finite:
        chosen = std::numeric_limits<float>::quiet_NaN();
        break;
      case FaultKind::infinite:
        chosen = std::numeric_limits<float>::infinity();
        break;
      case FaultKind::zero_quaternion:
        r.quaternion.fill(0);
        break;
      case FaultKind::displaced:
        r.position[0] += static_cast<float>(f.value / (settings_.centimetres ? 10 : 25.4));
        break;
      case FaultKind::damaged_counter:
        r.frame += static_cast<std::uint32_t>(static_cast<std::int64_t>(f.value));
        break;
      default:
        break;
    }
  }
}

std::uint8_t LibertyUnit::letter_at(int station, Stamp t) const {
  return station == 1 && letter_.at(t) ? static_cast<std::uint8_t>(letter_.value) : 0;
}

void LibertyUnit::send_record(Stamp reading_time, Stamp sent, int station, std::uint8_t command) {
  WireReading reading = reading_of(station, reading_time);
  damage_reading(reading, station, reading_time);
  const OutputList other{Item::position,    Item::quaternion, Item::time_ms,
                         Item::frame_count, Item::distortion, Item::sync};
  const OutputList& list =
      wrong_list_.at(reading_time) ? other : settings_.lists[static_cast<std::size_t>(station - 1)];

  WireBytes bytes;
  if (settings_.binary) {
    begin_frame(bytes, tag(), station, command, letter_at(station, reading_time));
    put_binary_items(bytes, list, reading);
    finish_frame(bytes);
  } else {
    bytes.format("%02.0f", station);
    if (command != 'P') bytes.byte(command);
    const std::uint8_t letter = letter_at(station, reading_time);
    bytes.byte(letter == 0 ? ' ' : letter);
    bytes.byte(' ');
    put_ascii_items(bytes, list, reading);
  }

  int copies = 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < once_count_; ++i) {
    const Fault& f = once_[i];
    if (f.station != station) {
      once_[kept++] = f;
      continue;
    }
    switch (f.kind) {
      case FaultKind::garbage:
        send_garbage(sent, static_cast<std::size_t>(f.value));
        break;
      case FaultKind::flood:
        send_flood(sent, static_cast<std::size_t>(f.value));
        break;
      case FaultKind::error_text: {
        WireBytes text;
        const auto code = static_cast<std::uint8_t>(f.value);
        begin_frame(text, tag(), 0, '?', code);
        text.text(liberty::error_text(code));
        text.text("\r\n");
        finish_frame(text);
        sink_(sent, text.view(), 0);
        break;
      }
      case FaultKind::dropped_byte: {
        const auto at = bytes.data.begin() + static_cast<std::ptrdiff_t>(
                                                 std::min(static_cast<std::size_t>(f.value), bytes.size - 1));
        std::copy(at + 1, bytes.data.begin() + static_cast<std::ptrdiff_t>(bytes.size), at);
        --bytes.size;
        break;
      }
      case FaultKind::flipped_size: {
        const auto bit = static_cast<std::size_t>(f.value) % 16;
        bytes.data[6 + bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
        break;
      }
      case FaultKind::duplicate_record:
        copies = 2;
        break;
      default:
        break;
    }
  }
  once_count_ = kept;
  for (int i = 0; i < copies; ++i) sink_(sent, bytes.view(), station);
}

void LibertyUnit::send_garbage(Stamp sent, std::size_t n) {
  WireBytes junk;
  while (n > 0) {
    junk.size = 0;
    while (n > 0 && junk.size < 512) {
      // Every now and then a tag, which may or may not be the begin of a header.
      const bool tag_next = uniform() < 0.05 && n >= 2;
      if (tag_next)
        junk.u16(static_cast<std::uint16_t>(tag()));
      else
        junk.byte(static_cast<std::uint8_t>(256 * uniform()));
      n -= tag_next ? 2 : 1;
    }
    sink_(sent, junk.view(), 0);
  }
}

void LibertyUnit::send_flood(Stamp sent, std::size_t n) {
  WireBytes lines;
  while (n > 0) {
    lines.size = 0;
    while (lines.size < std::min<std::size_t>(n, 480)) lines.text("01C     1.000    2.000   -3.000\r\n");
    n -= std::min(n, lines.size);
    sink_(sent, lines.view(), 0);
  }
}

void LibertyUnit::inject(const Fault& f) {
  const Until until{f.at + f.lasts, f.value};
  switch (f.kind) {
    case FaultKind::wrong_list:
      wrong_list_ = until;
      break;
    case FaultKind::negated_quaternion:
      negated_ = until;
      break;
    case FaultKind::mirrored:
      mirrored_ = until;
      break;
    case FaultKind::distortion:
      distortion_ = until;
      break;
    case FaultKind::error_letter:
      letter_ = until;
      break;
    case FaultKind::missing_records:
      missing_ = static_cast<int>(f.value);
      break;
    case FaultKind::counters_back:
      frame_ -= static_cast<std::uint32_t>(f.value);
      time_ms_ -= f.value * 1000 * seconds(period());
      break;
    case FaultKind::counters_near_wrap:
      frame_ = 0U - static_cast<std::uint32_t>(f.value);
      time_ms_ = 0x1p32 - f.value * 1000 * seconds(period());
      break;
    case FaultKind::station_silent:
      if (f.station >= 1 && f.station <= stations())
        unplugged_until_[static_cast<std::size_t>(f.station - 1)] = f.at + f.lasts;
      break;
    case FaultKind::ignored_starts:
      ignored_starts_ = static_cast<int>(f.value);
      break;
    case FaultKind::stream_stops:
      settings_.continuous = false;
      break;
    case FaultKind::settings_lost:
      settings_ = LibertySettings();
      break;
    case FaultKind::deaf_until_reset:
      deaf_ = Deaf::until_reset;
      break;
    case FaultKind::deaf_until_reinitialise:
      deaf_ = Deaf::until_reinitialise;
      break;
    case FaultKind::deaf:
      deaf_until_ = std::max(deaf_until_, f.at + f.lasts);
      break;
    default:
      if (once_count_ < once_.size()) once_[once_count_++] = f;
      break;
  }
}

}  // namespace sonoband::sim
