// The seam to video devices: what a streaming source asks of them. Behind it are Video4Linux
// (v4l2_device.cpp), libcamera (camera_device.cpp) and, in tests, a device of made-up answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "hal/devices.h"

namespace sonoband {

enum class VideoStatus : std::uint8_t {
  ok,
  nothing_yet,
  absent,         // no such device, or it is gone
  access_denied,  // the operating system refuses (udev rule missing)
  busy,           // another process streams from it
  not_video,      // a device, but none that streams pictures
  no_signal,      // an HDMI bridge without a cable or a source
  no_lock,        // a signal it cannot lock to
  out_of_range,   // a signal of a size or rate it cannot take
  interlaced,     // lines of two moments in one picture
  no_colour,      // Doppler is wanted, and no format that it offers gives its colours
  changed,        // the source changed its size: stop, negotiate, start
  failed,         // any other error of the kernel's
};

// One of the formats offered, or what was agreed on.
struct VideoMode {
  PixelFormat format = PixelFormat::yuyv;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  std::size_t bytes = 0;  // of a buffer
  double rate_hz = 0;     // pictures a second; 0 where the device does not say
};

struct VideoBuffer {
  int index = -1;
  std::span<const std::uint8_t> bytes;  // until it is queued again
  std::uint32_t sequence = 0;
  std::int64_t stamp_ns = 0;
  bool monotonic = false;  // the stamp is on CLOCK_MONOTONIC
  bool damaged = false;    // the driver says so
};

class VideoDevice {
 public:
  virtual ~VideoDevice() = default;
  virtual VideoStatus open() = 0;        // absent and the like leave it closed
  virtual std::string name() const = 0;  // of the open device and where it is, for people; else ""
  virtual std::vector<PixelFormat> formats() = 0;
  // Asks for it; `mode` becomes what the device agreed to, which may be something else.
  virtual VideoStatus negotiate(VideoMode& mode, double rate_hz) = 0;
  virtual VideoStatus start() = 0;  // maps and queues its buffers, and streams
  virtual VideoStatus take(VideoBuffer& out, Duration timeout) = 0;
  virtual VideoStatus give_back(int index) = 0;
  virtual void stop() = 0;   // unmaps
  virtual void close() = 0;  // of a closed device: nothing to do
};

}  // namespace sonoband
