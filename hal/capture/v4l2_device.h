// A video device of Linux by its system calls: memory-mapped streaming; an HDMI bridge is given an EDID where
// it has none, and its timings are taken over.
#pragma once

#include <array>
#include <string>

#include "hal/capture/kernel_calls.h"
#include "hal/capture/video_device.h"

namespace sonoband {

class V4l2Device final : public VideoDevice {
 public:
  // `path` is a device file (a link below /dev/v4l/by-id stays with its grabber), or "auto" for the first
  // device that streams pictures.
  explicit V4l2Device(std::string path, KernelCalls& kernel = kernel_calls())
      : kernel_(kernel), path_(std::move(path)) {}
  ~V4l2Device() override;

  VideoStatus open() override;
  std::string name() const override { return fd_ < 0 ? "" : card_ + " at " + opened_; }
  std::vector<PixelFormat> formats() override;
  VideoStatus negotiate(VideoMode& mode, double rate_hz) override;
  VideoStatus start() override;
  VideoStatus take(VideoBuffer& out, Duration timeout) override;
  VideoStatus give_back(int index) override;
  void stop() override;
  void close() override;

 private:
  VideoStatus open_one(const std::string& path);
  VideoStatus take_timings();
  void give_edid(const VideoMode& mode, double rate_hz);
  int call(unsigned long request, void* argument) { return kernel_.control(fd_, request, argument); }

  static constexpr int wanted_buffers = 4;
  struct Mapping {
    void* start = nullptr;
    std::size_t bytes = 0;
  };

  KernelCalls& kernel_;
  std::string path_;
  std::string opened_;
  std::string card_;
  int fd_ = -1;
  bool streaming_ = false;
  std::array<Mapping, wanted_buffers> mapped_{};
  int buffers_ = 0;
};

}  // namespace sonoband
