// A video device of made-up answers: what the source makes of everything a grabber does.
#include "hal/capture/video_source.h"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <vector>

#include "tests/hal/capture/fake_video.h"
#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

using test::at;

using test::video::height;
using test::video::Rig;
using test::video::width;

TEST(VideoSource, StreamsWithTheKernelsStampsAndThePreferredFormat) {
  Rig rig;
  rig.run_to(2);
  EXPECT_NEAR(static_cast<double>(rig.frames.size()), 100, 2);
  EXPECT_EQ(rig.device.format, PixelFormat::yuyv);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.health().lost, 0u);
  EXPECT_EQ(rig.frames[9].captured - rig.frames[8].captured, rig.device.period);
  EXPECT_EQ(rig.frames[9].arrived - rig.frames[9].captured, std::chrono::milliseconds(3));
}

TEST(VideoSource, AGapOfTheCountIsSoManyLost) {
  Rig rig;
  rig.run_to(1);
  rig.device.sequence += 5;
  rig.run_to(2);
  EXPECT_EQ(rig.health().lost, 5u);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

TEST(VideoSource, TheSameFrameTwiceIsHandedOutOnce) {
  Rig rig;
  rig.run_to(1);
  const auto before = rig.frames.size();
  --rig.device.sequence;
  rig.run_to(1.1);
  EXPECT_EQ(rig.health().lost, 0u);
  EXPECT_EQ(rig.frames.size(), before + 4);
}

TEST(VideoSource, AGrabberThatNeverCountsStreams) {
  Rig rig;
  rig.device.counts = false;
  rig.run_to(2);
  EXPECT_GE(rig.frames.size(), 95u);  // 50 a second
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.health().lost, 0u);
  EXPECT_EQ(rig.health().recoveries, 0u);
  EXPECT_EQ(rig.device.starts, 1);
  for (std::size_t i = 1; i < rig.frames.size(); ++i)
    ASSERT_EQ(rig.frames[i].sequence, rig.frames[i - 1].sequence + 1);
}

TEST(VideoSource, AFrameTwiceOfAGrabberThatNeverCountsIsHandedOutOnce) {
  Rig rig;
  rig.device.counts = false;
  rig.run_to(1);
  const auto before = rig.frames.size();
  rig.device.period = std::chrono::milliseconds(4);  // five buffers a picture
  rig.run_to(2);
  EXPECT_LE(rig.frames.size(), before + 100);  // no more than twice the grabber's rate
  EXPECT_EQ(rig.health().lost, 0u);
}

TEST(VideoSource, DamagedAndTooShortBuffersAreLost) {
  Rig rig;
  rig.run_to(1);
  rig.device.damage_next = true;
  rig.run_to(1.5);
  EXPECT_EQ(rig.health().lost, 1u);
  rig.device.bytes_per_picture -= 1;
  rig.run_to(2);
  EXPECT_NEAR(static_cast<double>(rig.health().lost), 26, 1);
  rig.device.bytes_per_picture += 1;
  rig.run_to(3);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

TEST(VideoSource, AStallIsRestartedAndCounted) {
  Rig rig;
  rig.run_to(2);
  rig.device.silent_until = at(6);
  rig.run_to(4.5);
  EXPECT_EQ(rig.health().state, DeviceState::stalled);
  EXPECT_GE(rig.health().recoveries, 2u);
  rig.run_to(8);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_GE(rig.device.starts, 3);
  EXPECT_LT(rig.clock.now() - rig.frames.back().captured, std::chrono::milliseconds(30));
}

// A count that stands still, or pictures that are all damaged, once looked like a grabber that runs.
TEST(VideoSource, AFloodWithoutANewPictureIsAStall) {
  for (const bool counts : {false, true}) {
    Rig rig;
    rig.run_to(1);
    const auto before = rig.frames.size();
    rig.device.period = std::chrono::microseconds(100);
    rig.device.counts = counts;
    if (counts) rig.device.bytes_per_picture = 7;
    rig.run_to(2.5);
    // Each restart may give one picture, whose number is then the first.
    EXPECT_LE(rig.frames.size(), before + 2);
    if (counts) {
      EXPECT_EQ(rig.health().state, DeviceState::stalled);
    }
    EXPECT_GE(rig.health().recoveries, 1u);
    rig.device.period = std::chrono::milliseconds(20);
    rig.device.counts = true;
    rig.device.bytes_per_picture = 2 * width * height;
    rig.run_to(5);
    EXPECT_EQ(rig.health().state, DeviceState::running);
  }
}

TEST(VideoSource, AFloodOfPicturesIsHandedOutOneByOneWithoutGrowing) {
  Rig rig;
  rig.run_to(0.5);
  rig.device.period = std::chrono::microseconds(50);
  Frame f;
  const test::AllocationCounter counter;
  for (int i = 0; i < 10'000; ++i) {
    EXPECT_EQ(rig.source.read(f, std::chrono::milliseconds(30)), ReadStatus::ok);
    EXPECT_LE(rig.device.lent, 1);
  }
  EXPECT_EQ(counter.count(), 0u);
}

TEST(VideoSource, AChangedSourceIsAskedAgainAndAnotherSizeIsRefused) {
  Rig rig;
  rig.run_to(1);
  rig.device.trouble = VideoStatus::changed;
  rig.run_to(1.2);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.device.starts, 2);
  rig.device.actual_width = 80;
  rig.device.trouble = VideoStatus::changed;
  const auto before = rig.frames.size();
  rig.run_to(3);
  EXPECT_EQ(rig.health().state, DeviceState::fault);
  EXPECT_EQ(rig.frames.size(), before);
  rig.device.actual_width = width;
  rig.run_to(5);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

// A thread of real-time priority that never sleeps is killed by the unit's LimitRTTIME, and the cart with it.
TEST(VideoSource, ASourceThatKeepsChangingIsAskedOnceASecond) {
  Rig rig;
  rig.run_to(1);
  rig.device.keeps_changing = true;
  const int before = rig.device.opens;
  rig.run_to(6);
  EXPECT_LE(rig.device.opens - before, 7);
  EXPECT_EQ(rig.health().state, DeviceState::stalled);
  EXPECT_STREQ(rig.health().reason, "The scanner changed its video mode; asking again what it sends.");
  rig.device.keeps_changing = false;
  rig.run_to(8);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

TEST(VideoSource, ARateTooLowIsComplainedAbout) {
  Rig rig;
  rig.device.rate_hz = 5;
  rig.device.offered = {PixelFormat::yuyv};
  rig.run_to(1);
  EXPECT_FALSE(rig.frames.empty()) << "better than none";
  EXPECT_EQ(rig.health().state, DeviceState::degraded);
  EXPECT_STREQ(
      rig.health().reason,
      "The grabber gives fewer pictures a second than capture.rate-hz: plug it into a USB 3 port, or "
      "correct that.");
}

TEST(VideoSource, UnpluggedAndBack) {
  Rig rig;
  rig.run_to(1);
  rig.device.trouble = VideoStatus::absent;
  rig.device.opening = VideoStatus::absent;
  rig.run_to(3);
  EXPECT_EQ(rig.health().state, DeviceState::absent);
  rig.device.opening = VideoStatus::ok;
  rig.device.sequence = 0;  // it counts anew
  rig.run_to(5);
  EXPECT_EQ(rig.health().state, DeviceState::running);
  EXPECT_EQ(rig.health().lost, 0u);
  EXPECT_EQ(rig.health().recoveries, 1u);
}

TEST(VideoSource, EveryReasonItCannotOpenIsSaidAndLookedForOnceASecond) {
  for (const VideoStatus why :
       {VideoStatus::absent, VideoStatus::access_denied, VideoStatus::busy, VideoStatus::not_video}) {
    Rig rig;
    rig.device.opening = why;
    rig.run_to(5.5);
    EXPECT_NEAR(rig.device.opens, 6, 1);
    EXPECT_STRNE(rig.health().reason, "");
    rig.device.opening = VideoStatus::ok;
    rig.run_to(7);
    EXPECT_EQ(rig.health().state, DeviceState::running);
  }
  for (const VideoStatus why :
       {VideoStatus::no_signal, VideoStatus::no_lock, VideoStatus::out_of_range, VideoStatus::interlaced}) {
    Rig rig;
    rig.device.negotiating = why;
    rig.run_to(1.5);
    EXPECT_STRNE(rig.health().reason, "");
    EXPECT_TRUE(rig.frames.empty());
  }
  Rig rig;
  rig.device.offered.clear();
  rig.run_to(0.5);
  EXPECT_EQ(rig.health().state, DeviceState::fault);
}

TEST(VideoSource, AStampOfAnotherClockIsNotBelieved) {
  for (const std::int64_t shift : {std::int64_t{5'000'000'000}, std::int64_t{-5'000'000'000}}) {
    Rig rig;
    rig.device.stamp_shift_ns = shift;
    rig.run_to(1);
    EXPECT_EQ(rig.frames.back().captured, rig.frames.back().arrived);
  }
}

std::vector<std::uint8_t> jpeg_of(int w, int h, const std::vector<std::uint8_t>& pixels, int format,
                                  int sampling) {
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const tjhandle handle = tjInitCompress();
  EXPECT_EQ(tjCompress2(handle, pixels.data(), w, 0, h, format, &bytes, &size, sampling, 90, 0), 0);
  std::vector<std::uint8_t> out(bytes, bytes + size);
  tjFree(bytes);
  tjDestroy(handle);
  return out;
}

std::vector<std::uint8_t> jpeg_of(int w, int h, std::uint8_t grey) {
  return jpeg_of(w, h, std::vector<std::uint8_t>(static_cast<std::size_t>(w * h), grey), TJPF_GRAY,
                 TJSAMP_GRAY);
}

TEST(VideoSource, MotionJpegIsDecodedAndWarnedAbout) {
  Rig rig;
  rig.device.offered.assign(1, PixelFormat::mjpeg);
  rig.device.jpeg = jpeg_of(width, height, 200);
  rig.run_to(0.5);
  EXPECT_EQ(rig.health().state, DeviceState::degraded);
  ASSERT_FALSE(rig.frames.empty());
  EXPECT_EQ(rig.frames.back().format, PixelFormat::grey8);
  constexpr std::size_t middle_row = height / 2;
  EXPECT_NEAR(rig.frames.back().data[middle_row * width], 200, 1);
}

TEST(VideoSource, WhereDopplerIsConfiguredAFormatWithColourIsTaken) {
  Rig rig(true);
  rig.device.offered = {PixelFormat::grey8, PixelFormat::nv12, PixelFormat::yuyv, PixelFormat::mjpeg};
  rig.run_to(0.5);
  EXPECT_EQ(rig.device.format, PixelFormat::yuyv);
  EXPECT_EQ(rig.health().state, DeviceState::running);
}

TEST(VideoSource, AGrabberWithoutColourIsSaidToBeNoneForDoppler) {
  Rig rig(true);
  rig.device.offered = {PixelFormat::grey8, PixelFormat::nv12};
  rig.run_to(0.5);
  EXPECT_TRUE(rig.frames.empty());
  EXPECT_EQ(rig.health().state, DeviceState::fault);
  EXPECT_NE(std::string(rig.health().reason).find("capture.colour"), std::string::npos);
}

TEST(VideoSource, MotionJpegIsDecodedInColourForDoppler) {
  Rig rig(true);
  rig.device.offered.assign(1, PixelFormat::mjpeg);
  std::vector<std::uint8_t> red(std::size_t{3} * width * height);
  for (std::size_t i = 0; i < red.size(); i += 3) red[i] = 220;
  rig.device.jpeg = jpeg_of(width, height, red, TJPF_RGB, TJSAMP_422);
  rig.run_to(0.5);
  ASSERT_FALSE(rig.frames.empty());
  const Frame& f = rig.frames.back();
  EXPECT_EQ(f.format, PixelFormat::rgb24);
  const std::uint8_t* middle = f.data + (height / 2) * f.stride_bytes + 3 * (width / 2);
  EXPECT_NEAR(middle[0], 220, 4);
  EXPECT_NEAR(middle[1], 0, 4);
  EXPECT_NEAR(middle[2], 0, 4);
  // Of another size, or cut off: lost.
  for (const bool cut : {false, true}) {
    Rig bad(true);
    bad.device.offered.assign(1, PixelFormat::mjpeg);
    bad.device.jpeg = cut ? rig.device.jpeg : jpeg_of(2 * width, height, 9);
    if (cut) bad.device.jpeg.resize(bad.device.jpeg.size() / 2);
    bad.run_to(0.5);
    EXPECT_TRUE(bad.frames.empty());
    EXPECT_GE(bad.health().lost, 20u);
  }
}

TEST(VideoSource, JpegsThatAreCutOffOrOfAnotherSizeAreLost) {
  for (int which = 0; which < 3; ++which) {
    Rig rig;
    rig.device.offered.assign(1, PixelFormat::mjpeg);
    rig.device.jpeg = jpeg_of(which == 0 ? 2 * width : width, height, 9);
    if (which == 1) rig.device.jpeg.resize(rig.device.jpeg.size() / 2);
    if (which == 2) rig.device.jpeg.assign(100, 0xff);
    rig.run_to(0.5);
    EXPECT_TRUE(rig.frames.empty()) << which;
    EXPECT_GE(rig.health().lost, 20u);
  }
}

}  // namespace
}  // namespace sonoband
