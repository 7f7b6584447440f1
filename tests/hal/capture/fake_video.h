// A grabber of made-up answers, and the source that reads it.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "hal/capture/luma.h"
#include "hal/capture/video_source.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband::test::video {

inline constexpr int width = 64;
inline constexpr int height = 48;

class FakeVideo final : public VideoDevice {
 public:
  explicit FakeVideo(Clock& clock) : clock_(clock) {
    offered.push_back(PixelFormat::mjpeg);
    offered.push_back(PixelFormat::yuyv);
  }

  VideoStatus open() override {
    ++opens;
    is_open = opening == VideoStatus::ok;
    return opening;
  }
  std::string name() const override { return "made up"; }
  std::vector<PixelFormat> formats() override { return offered; }
  VideoStatus negotiate(VideoMode& mode, double /*rate_hz*/) override {
    mode.width = actual_width;
    mode.stride_bytes = (mode.format == PixelFormat::yuyv ? 2 : 1) * mode.width;
    mode.rate_hz = rate_hz;
    format = mode.format;
    return negotiating;
  }
  VideoStatus start() override {
    ++starts;
    lent = 0;
    next_ = clock_.now() + period;
    return VideoStatus::ok;
  }
  VideoStatus take(VideoBuffer& out, Duration timeout) override {
    const Stamp until = clock_.now() + timeout;
    if (trouble != VideoStatus::ok || keeps_changing) {
      clock_.sleep_until(clock_.now() + std::chrono::milliseconds(1));
      return keeps_changing ? VideoStatus::changed : std::exchange(trouble, VideoStatus::ok);
    }
    while (next_ < silent_until) next_ += period;
    if (next_ > until) {
      clock_.sleep_until(until);
      return VideoStatus::nothing_yet;
    }
    clock_.sleep_until(next_);
    EXPECT_LT(lent, 4) << "buffers are given back";
    ++lent;
    picture.assign(static_cast<std::size_t>(bytes_per_picture), static_cast<std::uint8_t>(sequence));
    if (!jpeg.empty()) picture = jpeg;
    out.index = 0;
    out.bytes = picture;
    out.sequence = counts ? sequence++ : sequence;
    out.stamp_ns = (next_ - std::chrono::milliseconds(3)).time_since_epoch().count() + stamp_shift_ns;
    out.monotonic = true;
    out.damaged = std::exchange(damage_next, false);
    next_ += period;
    return VideoStatus::ok;
  }
  VideoStatus give_back(int /*index*/) override {
    --lent;
    return VideoStatus::ok;
  }
  void stop() override {}
  void close() override { is_open = false; }

  VideoStatus opening = VideoStatus::ok;
  VideoStatus negotiating = VideoStatus::ok;
  VideoStatus trouble = VideoStatus::ok;  // of the next take
  std::vector<PixelFormat> offered;
  bool keeps_changing = false;  // its source, without a picture between
  int actual_width = width;
  double rate_hz = 0;
  int bytes_per_picture = 2 * width * height;
  std::vector<std::uint8_t> picture;
  std::vector<std::uint8_t> jpeg;
  Duration period = std::chrono::milliseconds(20);
  Stamp silent_until{};
  std::uint32_t sequence = 7;
  std::int64_t stamp_shift_ns = 0;
  bool damage_next = false;
  bool counts = true;
  int lent = 0;
  int opens = 0;
  int starts = 0;
  bool is_open = false;
  PixelFormat format{};

 private:
  Clock& clock_;
  Stamp next_{};
};

struct Rig {
  explicit Rig(bool colour = false)
      : source(device, clock, {.width = width, .height = height, .rate_hz = 50, .colour = colour}) {
    source.start();
  }
  void run_to(double s) {
    Frame f;
    while (clock.now() < at(s)) {
      const Duration patience = std::min<Duration>(std::chrono::milliseconds(30), at(s) - clock.now());
      if (source.read(f, patience) != ReadStatus::ok) continue;
      if (!frames.empty()) {
        EXPECT_GT(f.sequence, frames.back().sequence);
        EXPECT_GT(f.captured, frames.back().captured);
      }
      EXPECT_LE(f.captured, f.arrived);
      EXPECT_EQ(check_frame(f, width, height), FrameFault::none);
      frames.push_back(f);
    }
  }
  DeviceHealth health() const { return source.health(); }

  test::SteppedClock clock;
  FakeVideo device{clock};
  VideoSource source;
  std::vector<Frame> frames;
};

}  // namespace sonoband::test::video
