// A camera of libcamera as a video device, so that the source above (video_source.h) keeps it streaming as it
// does a device of Video4Linux: for sensors, which need libcamera's pipelines, and USB grabbers. Bridges from
// HDMI are not seen by libcamera: those are Video4Linux's (v4l2_device.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/capture/camera_calls.h"
#include "hal/capture/video_device.h"

namespace sonoband {

class CameraDevice final : public VideoDevice {
 public:
  CameraDevice(std::unique_ptr<CameraCalls> calls, std::string id);
  ~CameraDevice() override;

  VideoStatus open() override;
  std::string name() const override;
  std::vector<PixelFormat> formats() override;
  VideoStatus negotiate(VideoMode& mode, double rate_hz) override;
  VideoStatus start() override;
  VideoStatus take(VideoBuffer& out, Duration timeout) override;
  VideoStatus give_back(int index) override;
  void stop() override;
  void close() override;

 private:
  std::unique_ptr<CameraCalls> calls_;
  std::string id_;
  bool open_ = false;
  bool streaming_ = false;
  double rate_hz_ = 0;
  std::vector<std::span<const std::uint8_t>> buffers_;
  std::vector<bool> lent_;  // which of them the camera does not have
};

}  // namespace sonoband
