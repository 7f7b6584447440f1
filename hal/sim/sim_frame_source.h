// The scanner's video as a frame grabber would deliver it, with its faults.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"

namespace sonoband::sim {

// Paints what is on the scanner's output at `captured`.
using PaintFrame = std::function<void(Stamp captured, std::uint8_t* out, std::ptrdiff_t stride_bytes)>;

struct FrameFault {
  enum class Kind : std::uint8_t {
    drop,       // the device counts frames that never arrive: a jump of the sequence
    freeze,     // the picture of the frame before comes again, with new stamps and numbers
    late,       // frames arrive `by` later than they should
    stall,      // the device says nothing and counts nothing
    unplug,     // gone; comes back counting from 0
    cable_out,  // the grabber is there but sees no signal
    resize,     // the scanner's output changes to width x height
  } kind = Kind::drop;
  Duration from{};  // of the frames captured from..until, counted from start()
  Duration until{};
  Duration by{};
  int width = 0;
  int height = 0;
};

struct FrameSourceSettings {
  int width_px = 640;
  int height_px = 480;
  PixelFormat format = PixelFormat::grey8;           // or rgb24
  double rate_hz = 30;                               // 25, 30, 50 or 60
  Duration latency = std::chrono::milliseconds(25);  // from the scanner's output to the host
  Duration jitter = std::chrono::milliseconds(2);    // arrivals are up to this much later, never out of order
  double device_clock_ppm = 40;                      // the device's clock runs fast by this
  int buffers = 4;                                   // frames the driver keeps for a slow reader
  std::uint64_t seed = 1;
  std::vector<FrameFault> faults = {};
};

class SimFrameSource final : public FrameSource {
 public:
  SimFrameSource(Clock& clock, const FrameSourceSettings& settings, PaintFrame paint);

  void start() override;
  ReadStatus read(Frame& out, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

 private:
  Stamp captured(std::uint64_t n) const;
  Stamp arrival(std::uint64_t n) const;  // before order is kept
  const FrameFault* fault(std::uint64_t n, FrameFault::Kind kind) const;
  bool pass_over(Stamp asked);  // the next frame is one that no reader gets
  Frame deliver();

  Clock& clock_;
  FrameSourceSettings settings_;
  PaintFrame paint_;
  int pixel_bytes_;
  Stamp started_{};
  std::uint64_t next_ = 0;  // frame since start
  std::uint64_t sequence_ = 0;
  bool painted_ = false;  // frame next_ is in picture_
  bool any_painted_ = false;
  bool was_gone_ = false;
  Stamp last_arrival_{};
  std::vector<std::uint8_t> picture_;
  std::vector<std::uint8_t> resized_;

  SharedHealth health_;
};

}  // namespace sonoband::sim
