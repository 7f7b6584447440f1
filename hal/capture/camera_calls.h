// The seam to libcamera: the few calls that a camera's driver needs. Behind it are libcamera
// (libcamera_calls.cpp) and, in tests, a camera of made-up answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"

namespace sonoband {

enum class CameraError : std::uint8_t {
  none,
  absent,   // no such camera, or it is gone
  busy,     // another process holds it
  refused,  // not with these settings
  failed,
};

// One of a camera's formats as Linux's display drivers count them (DRM), and what was agreed on.
struct CameraMode {
  std::uint32_t fourcc = 0;
  unsigned width = 0;
  unsigned height = 0;
  unsigned stride_bytes = 0;
  unsigned bytes = 0;  // of a picture
};

// A buffer the camera is done with. Its numbers are the camera's, checked by nobody yet.
struct CameraCompletion {
  int slot = -1;
  std::uint32_t sequence = 0;
  std::int64_t stamp_ns = 0;  // on CLOCK_MONOTONIC where the machine was never suspended
  std::size_t bytes = 0;      // filled, from the buffer's first
  bool whole = false;         // neither damaged nor cancelled
};

class CameraCalls {
 public:
  virtual ~CameraCalls() = default;

  // `id` is the library's name for a camera, "auto" the first. Takes it for this process alone.
  virtual CameraError open(const std::string& id) = 0;
  virtual std::string name() const = 0;  // of the open camera
  virtual std::vector<std::uint32_t> formats() = 0;
  // `mode` becomes what the camera agreed to, which may be something else.
  virtual CameraError configure(CameraMode& mode) = 0;
  // Maps its buffers, hands all of them to the camera and streams. `buffers` live until stop; one whose
  // planes do not follow each other in memory ends where its first one does.
  virtual CameraError start(double rate_hz, std::vector<std::span<const std::uint8_t>>& buffers) = 0;
  // True with the next buffer that is done, oldest first; false when the time is over, or the camera gone.
  virtual bool wait(CameraCompletion& out, Duration timeout) = 0;
  virtual bool gone() const = 0;
  virtual CameraError queue(int slot) = 0;
  virtual void stop() = 0;
  virtual void close() = 0;
};

std::unique_ptr<CameraCalls> libcamera_calls();

}  // namespace sonoband
