// Which format is taken of a grabber that gives some better than others.
#include "hal/capture/agreement.h"

#include <gtest/gtest.h>

#include <map>

namespace sonoband {
namespace {

struct Answer {
  int width = 1920;
  double rate_hz = 60;
  VideoStatus status = VideoStatus::ok;
};

class Grabber final : public VideoDevice {
 public:
  explicit Grabber(std::map<PixelFormat, Answer> answers) : answers_(std::move(answers)) {}
  VideoStatus open() override { return VideoStatus::ok; }
  std::string name() const override { return "made up"; }
  std::vector<PixelFormat> formats() override {
    std::vector<PixelFormat> offered;
    // Worst first: its order means nothing.
    for (auto a = answers_.rbegin(); a != answers_.rend(); ++a) offered.push_back(a->first);
    return offered;
  }
  VideoStatus negotiate(VideoMode& mode, double rate_hz) override {
    EXPECT_EQ(rate_hz, 60);
    EXPECT_EQ(mode.width, 1920);
    EXPECT_EQ(mode.height, 1080);
    const Answer& answer = answers_.at(mode.format);
    now = mode.format;
    mode.width = answer.width;
    mode.rate_hz = answer.rate_hz;
    return answer.status;
  }
  VideoStatus start() override { return VideoStatus::ok; }
  VideoStatus take(VideoBuffer&, Duration) override { return VideoStatus::nothing_yet; }
  VideoStatus give_back(int) override { return VideoStatus::ok; }
  void stop() override {}
  void close() override {}

  PixelFormat now{};  // what it would stream

 private:
  std::map<PixelFormat, Answer> answers_;
};

Agreement of(std::map<PixelFormat, Answer> answers, bool colour = false) {
  Grabber grabber(std::move(answers));
  const Agreement result = agree(grabber, {.width = 1920, .height = 1080, .rate_hz = 60, .colour = colour});
  EXPECT_TRUE(result.status != VideoStatus::ok || grabber.now == result.mode.format);
  return result;
}

using enum PixelFormat;

TEST(Agreement, TheBestFormatThatGivesTheSizeAndTheRateIsTaken) {
  EXPECT_EQ(of({{grey8, {}}, {yuyv, {}}, {mjpeg, {}}}).mode.format, grey8);
  EXPECT_EQ(of({{yuyv, {.rate_hz = 59.94}}, {mjpeg, {}}}).mode.format, yuyv);
  EXPECT_EQ(of({{yuyv, {.rate_hz = 0}}, {mjpeg, {}}}).mode.format, yuyv) << "it does not say its rate";
  EXPECT_EQ(of({{nv12, {.width = 1280}}, {yuyv, {}}}).mode.format, yuyv);
  EXPECT_EQ(of({{nv12, {.status = VideoStatus::failed}}, {yuyv, {}}}).mode.format, yuyv);
  EXPECT_EQ(of({{nv12, {.status = VideoStatus::out_of_range}}, {yuyv, {}}}).mode.format, yuyv);
  EXPECT_EQ(of({{nv12, {}}, {uyvy, {}}, {mjpeg, {}}}, true).mode.format, uyvy) << "NV12 has no colour here";
}

// A cheap grabber, or a better one in a USB 2 port: 5 whole pictures a second or 60 compressed ones.
TEST(Agreement, AFormatThatIsTooSlowIsTakenOnlyWhereNoneIsFaster) {
  const Agreement compressed = of({{yuyv, {.rate_hz = 5}}, {mjpeg, {}}});
  EXPECT_EQ(compressed.mode.format, mjpeg);
  EXPECT_FALSE(compressed.slow);
  const Agreement slow = of({{nv12, {.rate_hz = 5}}, {yuyv, {.rate_hz = 30}}, {rgb24, {.rate_hz = 10}}});
  EXPECT_EQ(slow.status, VideoStatus::ok);
  EXPECT_EQ(slow.mode.format, yuyv);
  EXPECT_EQ(slow.mode.rate_hz, 30);
  EXPECT_TRUE(slow.slow);
  EXPECT_TRUE(of({{yuyv, {.rate_hz = 50}}}).slow) << "50 Hz is not 60";
}

TEST(Agreement, WhatIsWrongIsSaid) {
  EXPECT_EQ(of({}).status, VideoStatus::not_video);
  EXPECT_EQ(of({{nv12, {}}}, true).status, VideoStatus::no_colour);
  const Agreement other_size = of({{yuyv, {.width = 640}}, {mjpeg, {.width = 1280}}});
  EXPECT_EQ(other_size.status, VideoStatus::out_of_range);
  EXPECT_EQ(other_size.mode.width, 1280);
  for (const VideoStatus why : {VideoStatus::no_signal, VideoStatus::no_lock, VideoStatus::interlaced,
                                VideoStatus::absent, VideoStatus::busy})
    EXPECT_EQ(of({{yuyv, {.status = why}}, {mjpeg, {}}}).status, why) << "whatever other formats there are";
}

}  // namespace
}  // namespace sonoband
