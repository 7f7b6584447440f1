// The scanner's pictures from a video device: kept streaming whatever the device does.
//
// Each frame carries the kernel's stamp and count. A jump of the count is that many lost; a buffer the driver
// calls damaged, or whose bytes do not hold the picture, is lost too. Of a grabber that never counted a frame
// lost ones are not known; a later stamp is a new frame. A source that is silent too long is
// restarted, and after the third time in a row opened anew; one that changed its picture is asked again what
// it sends. A frame is valid until the next read.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/image/image.h"
#include "hal/capture/jpeg_luma.h"
#include "hal/capture/video_device.h"
#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"

namespace sonoband {

struct VideoSettings {
  int width = 1920;  // of the whole captured picture; another size is refused, since it changes the scale
  int height = 1080;
  double rate_hz = 60;
  Duration silent = std::chrono::seconds(1);  // without a picture for longer it is restarted
  bool colour = false;  // Doppler: frames come in a format that FlowKeys takes colour from
};

class VideoSource final : public FrameSource {
 public:
  // `device` and `clock` outlive it.
  VideoSource(VideoDevice& device, Clock& clock, const VideoSettings& settings);
  ~VideoSource() override;

  void start() override;
  ReadStatus read(Frame& out, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

  // What was agreed with the device last; empty before.
  std::optional<VideoMode> mode() const { return mode_; }

 private:
  enum class State : std::uint8_t { closed, streaming };

  VideoStatus bring_up();
  bool is_later(const VideoBuffer& buffer) const;
  bool accept(const VideoBuffer& buffer, Frame& out);
  bool decode(const VideoBuffer& buffer, Frame& out);
  void trouble(VideoStatus why);
  void close();

  VideoDevice& device_;
  Clock& clock_;
  const VideoSettings settings_;
  State state_ = State::closed;
  bool started_ = false;
  bool ever_streamed_ = false;
  std::optional<VideoMode> mode_;
  const char* complaint_ = "";        // about that mode
  bool picture_since_change_ = true;  // since the source last changed
  JpegLuma jpeg_;
  Pixels decoded_;                         // of motion JPEG: luma
  std::vector<std::uint8_t> decoded_rgb_;  // or colour
  int held_ = -1;                          // the buffer lent out
  Stamp next_open_{};
  Stamp last_frame_{};
  int silent_restarts_ = 0;
  std::optional<std::uint32_t> last_sequence_;
  std::int64_t last_device_ns_ = 0;  // stamp of that frame
  bool counts_ = false;              // this grabber's count has been seen to move since the start
  std::uint64_t sequence_ = 0;       // of ours: goes on over restarts
  std::optional<Stamp> last_stamp_;

  SharedHealth health_;
};

}  // namespace sonoband
