#include "hal/sim/sim_frame_source.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "hal/sim/random.h"

namespace sonoband::sim {

using Kind = FrameFault::Kind;

SimFrameSource::SimFrameSource(Clock& clock, const FrameSourceSettings& settings, PaintFrame paint)
    : clock_(clock),
      settings_(settings),
      paint_(std::move(paint)),
      pixel_bytes_(settings.format == PixelFormat::rgb24 ? 3 : 1) {
  assert(settings.format == PixelFormat::rgb24 || settings.format == PixelFormat::grey8);
  const auto bytes = [this](int w, int h) { return static_cast<std::size_t>(w) * h * pixel_bytes_; };
  picture_.resize(bytes(settings.width_px, settings.height_px));
  for (const FrameFault& f : settings.faults) {
    if (f.kind == Kind::resize) resized_.resize(std::max(resized_.size(), bytes(f.width, f.height)));
  }
}

void SimFrameSource::start() {
  started_ = clock_.now();
  next_ = 0;
  sequence_ = 0;
  painted_ = false;
  any_painted_ = false;
  was_gone_ = false;
  last_arrival_ = started_;
  health_.say(DeviceState::starting, "");
}

void SimFrameSource::stop() {
  health_.say(DeviceState::absent, "");
}

Stamp SimFrameSource::captured(std::uint64_t n) const {
  return started_ + from_seconds(static_cast<double>(n) / settings_.rate_hz);
}

Stamp SimFrameSource::arrival(std::uint64_t n) const {
  const FrameFault* late = fault(n, Kind::late);
  return captured(n) + settings_.latency +
         from_seconds(seconds(settings_.jitter) * uniform(settings_.seed, n)) +
         (late != nullptr ? late->by : Duration(0));
}

const FrameFault* SimFrameSource::fault(std::uint64_t n, Kind kind) const {
  const Duration t = captured(n) - started_;
  for (const FrameFault& f : settings_.faults) {
    if (f.kind == kind && t >= f.from && t < f.until) return &f;
  }
  return nullptr;
}

bool SimFrameSource::pass_over(Stamp asked) {
  if (fault(next_, Kind::unplug) != nullptr) {
    health_.say(DeviceState::absent, "The frame grabber is not connected: plug it in.");
    was_gone_ = true;
    sequence_ = 0;
    return true;
  }
  if (fault(next_, Kind::cable_out) != nullptr) {
    health_.say(DeviceState::fault, "No signal from the scanner: check the video cable.");
    was_gone_ = true;
    return true;
  }
  if (fault(next_, Kind::stall) != nullptr) {
    health_.say(DeviceState::stalled, "The frame grabber has stopped sending pictures.");
    was_gone_ = true;
    return true;
  }
  // A reader that comes later than the driver has buffers for finds the oldest frames gone. Frames that
  // themselves were late do not count against it.
  const auto spare = static_cast<std::uint64_t>(settings_.buffers);
  const Duration covered = captured(spare + 1) - captured(0);
  const bool overrun = asked > std::max({arrival(next_), arrival(next_ + spare), last_arrival_ + covered});
  if (overrun || fault(next_, Kind::drop) != nullptr) {
    ++sequence_;
    ++health_.lost;
    return true;
  }
  return false;
}

ReadStatus SimFrameSource::read(Frame& out, Duration timeout) {
  const Stamp asked = clock_.now();
  const Stamp deadline = asked + timeout;
  const auto reached = [&](Stamp t) {
    if (clock_.now() < t) clock_.sleep_until(std::min(t, deadline));
    return clock_.now() >= t;
  };
  for (;; ++next_, painted_ = false) {
    if (!reached(captured(next_))) return ReadStatus::nothing_yet;
    if (pass_over(asked)) continue;
    // Painted before it is due, so that the time it takes does not delay it.
    if (!painted_) {
      const bool frozen = any_painted_ && fault(next_, Kind::freeze) != nullptr;
      if (!frozen) {
        paint_(captured(next_), picture_.data(),
               static_cast<std::ptrdiff_t>(settings_.width_px) * pixel_bytes_);
      }
      painted_ = any_painted_ = true;
    }
    if (!reached(std::max(arrival(next_), last_arrival_))) return ReadStatus::nothing_yet;
    out = deliver();
    ++next_;
    painted_ = false;
    return ReadStatus::ok;
  }
}

Frame SimFrameSource::deliver() {
  Frame f;
  f.data = picture_.data();
  f.width = settings_.width_px;
  f.height = settings_.height_px;
  if (const FrameFault* resize = fault(next_, Kind::resize)) {
    f.width = resize->width;
    f.height = resize->height;
    for (int y = 0; y < f.height; ++y) {
      for (int x = 0; x < f.width; ++x) {
        const int from_x = x * settings_.width_px / f.width;
        const int from_y = y * settings_.height_px / f.height;
        const std::uint8_t* from =
            &picture_[(static_cast<std::size_t>(from_y) * settings_.width_px + from_x) * pixel_bytes_];
        std::copy_n(from, pixel_bytes_,
                    &resized_[(static_cast<std::size_t>(y) * f.width + x) * pixel_bytes_]);
      }
    }
    f.data = resized_.data();
  }
  f.stride_bytes = static_cast<std::ptrdiff_t>(f.width) * pixel_bytes_;
  f.bytes = static_cast<std::size_t>(f.stride_bytes) * f.height;
  f.format = settings_.format;
  f.captured = captured(next_);
  f.arrived = last_arrival_ = std::max(arrival(next_), last_arrival_);
  const double device_s = seconds(f.captured - started_) * (1 + settings_.device_clock_ppm * 1e-6);
  f.device_stamp_ns = std::llround(device_s * 1e9);
  f.sequence = sequence_++;
  if (was_gone_) ++health_.recoveries;
  was_gone_ = false;
  ++health_.delivered;
  health_.say(DeviceState::running, "");
  return f;
}

DeviceHealth SimFrameSource::health() const {
  return health_.read();
}

}  // namespace sonoband::sim
