// The devices of the cart, one small interface each. Real drivers and simulators are equals behind them.
//
// Threads: start, read and stop are called by one thread; health may be called by any.
// Time: every stamp is on CLOCK_MONOTONIC; a device's own clock is converted once, inside its driver, and
// kept raw beside. "Nothing yet" is not an error. A device that is gone says so through health and keeps
// trying to come back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/sweep/pose_sample.h"
#include "core/time.h"

namespace sonoband {

enum class DeviceState : std::uint8_t {
  absent,    // not there (unplugged, or never seen)
  starting,  // there, not delivering yet
  running,
  degraded,  // delivering, with something wrong (see reason)
  stalled,   // there, silent longer than it should be
  fault,     // needs the operator (see reason)
};

struct DeviceHealth {
  DeviceState state = DeviceState::absent;
  const char* reason = "";       // one sentence with the cure, static storage; "" while all is well
  std::uint64_t delivered = 0;   // readings handed out since start
  std::uint64_t lost = 0;        // readings the device counted that never arrived
  std::uint32_t recoveries = 0;  // times the driver had to restart the device
};

enum class ReadStatus : std::uint8_t {
  ok,
  nothing_yet,  // the time ran out
  ended,        // no more will come (a replay is over)
};

class Tracker {
 public:
  virtual ~Tracker() = default;
  virtual void start() = 0;
  // Waits up to `timeout` for at least one reading; `count` of `out` are filled, oldest first.
  virtual ReadStatus read(std::span<PoseSample> out, std::size_t& count, Duration timeout) = 0;
  virtual DeviceHealth health() const = 0;
  virtual void stop() = 0;
};

enum class PixelFormat : std::uint8_t { grey8, rgb24, yuyv, uyvy, nv12, mjpeg };

// A borrowed raw capture, valid until the next read or stop of its source.
struct Frame {
  const std::uint8_t* data = nullptr;
  std::size_t bytes = 0;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  PixelFormat format = PixelFormat::grey8;
  Stamp captured{};  // when the picture was on the scanner's output, before the latency offset
  Stamp arrived{};   // when the host had it
  std::int64_t device_stamp_ns = 0;  // raw, on the device's or kernel's own clock
  std::uint64_t sequence = 0;        // the device's own count: a jump is a counted loss
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual void start() = 0;
  virtual ReadStatus read(Frame& out, Duration timeout) = 0;
  virtual DeviceHealth health() const = 0;
  virtual void stop() = 0;
};

// A raw contact edge, bounce included; hal/footswitch/debounce.h makes presses of them.
struct PedalEdge {
  Stamp time{};            // kernel stamp of the edge
  bool closed = false;     // contact closed = pedal down
  std::uint8_t pedal = 0;  // 0 is the record pedal
  // Per pedal, from 1: a jump means edges were lost and `closed` was re-read. 0 is no edge but the level at
  // start and whenever the pedal has come back: a driver gives it first.
  std::uint64_t sequence = 0;
};

class Footswitch {
 public:
  virtual ~Footswitch() = default;
  virtual void start() = 0;
  virtual ReadStatus read(PedalEdge& out, Duration timeout) = 0;
  virtual DeviceHealth health() const = 0;
  virtual void stop() = 0;
};

// One change of one contact on the touchscreen, in parts of the panel: a driver does not know the display's
// mode.
struct TouchEvent {
  Stamp time{};
  enum class Kind : std::uint8_t { down, move, up } kind = Kind::down;
  std::int32_t contact = 0;  // the same from down to up
  float x = 0;               // 0 at the picture's left edge, 1 at its right
  float y = 0;               // 0 at its top, 1 at its bottom
  float major_mm = 0;        // size of the contact; 0 where the panel does not say
};

class Touch {
 public:
  virtual ~Touch() = default;
  virtual void start() = 0;
  virtual ReadStatus read(TouchEvent& out, Duration timeout) = 0;
  virtual DeviceHealth health() const = 0;
  virtual void stop() = 0;
};

}  // namespace sonoband
