// An HDMI bridge of made-up answers at the system calls of Video4Linux: EDID, timings, formats, buffers,
// change of source; and devices that answer nonsense.
#include "hal/capture/v4l2_device.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <set>
#include <vector>

namespace sonoband {
namespace {

class Bridge final : public KernelCalls {
 public:
  int open(const std::string& path) override { return path == "/dev/video0" ? opening : -ENOENT; }
  int control(int fd, unsigned long request, void* argument) override {
    EXPECT_EQ(fd, 3);
    if (refused.contains(request)) return refused[request];
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& about = *static_cast<v4l2_capability*>(argument);
        std::memset(about.card, 'x', sizeof(about.card));  // without an end
        about.capabilities = capabilities;
        return 0;
      }
      case VIDIOC_G_EDID: {
        auto& e = *static_cast<v4l2_edid*>(argument);
        if (edid.empty()) return -ENODATA;
        e.blocks = 1;
        return 0;
      }
      case VIDIOC_S_EDID: {
        const auto& e = *static_cast<const v4l2_edid*>(argument);
        edid.assign(e.edid, e.edid + 128 * e.blocks);
        return 0;
      }
      case VIDIOC_QUERY_DV_TIMINGS: {
        auto& t = *static_cast<v4l2_dv_timings*>(argument);
        if (edid.empty()) return -ENOLINK;  // the scanner sees no display
        t.bt.width = 1280;
        t.bt.height = 720;
        t.bt.interlaced = interlaced ? V4L2_DV_INTERLACED : V4L2_DV_PROGRESSIVE;
        return 0;
      }
      case VIDIOC_S_DV_TIMINGS:
        taken_width = static_cast<const v4l2_dv_timings*>(argument)->bt.width;
        return 0;
      case VIDIOC_ENUM_FMT: {
        auto& f = *static_cast<v4l2_fmtdesc*>(argument);
        f.pixelformat = f.index % 2 == 0 ? V4L2_PIX_FMT_UYVY : V4L2_PIX_FMT_SBGGR8;
        return f.index < offered ? 0 : -EINVAL;
      }
      case VIDIOC_S_FMT: {
        auto& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
        pix.width = answered_width == 0 ? taken_width : answered_width;
        pix.height = 720;
        pix.bytesperline = 2 * pix.width;
        pix.sizeimage = 2 * 1280 * 720;
        EXPECT_EQ(pix.field, V4L2_FIELD_NONE) << "a driver that can give whole pictures is asked for them";
        pix.field = field;
        return 0;
      }
      case VIDIOC_S_PARM: {
        auto& asked = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
        if (period.denominator > 0) asked = period;
        return 0;
      }
      case VIDIOC_REQBUFS: {
        auto& r = *static_cast<v4l2_requestbuffers*>(argument);
        if (r.count > 0) r.count = granted;
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& b = *static_cast<v4l2_buffer*>(argument);
        b.length = buffer_bytes;
        b.m.offset = b.index;
        return 0;
      }
      case VIDIOC_DQEVENT:
        static_cast<v4l2_event*>(argument)->type = V4L2_EVENT_SOURCE_CHANGE;
        events = false;
        return 0;
      case VIDIOC_DQBUF: {
        if (said.empty()) return -EAGAIN;
        *static_cast<v4l2_buffer*>(argument) = said.front();
        said.pop_front();
        return 0;
      }
      default:
        return 0;
    }
  }
  void* map(int /*fd*/, std::size_t bytes, std::int64_t offset) override {
    if (bytes == 0 || offset == no_memory_at) return nullptr;
    memory[offset].assign(bytes, static_cast<std::uint8_t>(offset));
    ++mapped;
    return memory[offset].data();
  }
  void unmap(void* /*start*/, std::size_t /*bytes*/) override { --mapped; }
  int wait(int /*fd*/, Duration /*timeout*/) override {
    if (events) return POLLPRI | POLLIN;
    return said.empty() ? 0 : POLLIN;
  }
  void close(int fd) override { EXPECT_EQ(fd, 3); }

  int opening = 3;
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::map<unsigned long, int> refused;
  std::vector<std::uint8_t> edid;
  bool interlaced = false;
  bool events = false;
  std::uint32_t field = V4L2_FIELD_NONE;
  v4l2_fract period{};  // of what it grabs; 0: as asked
  std::uint32_t taken_width = 0;
  std::uint32_t answered_width = 0;
  std::uint32_t offered = 2;
  std::uint32_t granted = 4;
  std::uint32_t buffer_bytes = 2 * 1280 * 720;
  std::int64_t no_memory_at = -1;
  std::deque<v4l2_buffer> said;
  std::map<std::int64_t, std::vector<std::uint8_t>> memory;
  int mapped = 0;
};

struct Rig {
  VideoStatus negotiate() {
    EXPECT_EQ(device.open(), VideoStatus::ok);
    mode = {.format = PixelFormat::uyvy, .width = 1280, .height = 720};
    return device.negotiate(mode, 60);
  }
  Bridge bridge;
  V4l2Device device{"auto", bridge};
  VideoMode mode;
};

v4l2_buffer filled(std::uint32_t index, std::uint32_t bytes) {
  v4l2_buffer b{};
  b.index = index;
  b.bytesused = bytes;
  b.sequence = 11;
  b.timestamp = {5, 6};
  b.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  return b;
}

TEST(V4l2Device, ABridgeWithoutEdidGetsOneAndItsTimingsAreTakenOver) {
  Rig rig;
  EXPECT_EQ(rig.negotiate(), VideoStatus::ok);
  ASSERT_EQ(rig.bridge.edid.size(), 128u);
  EXPECT_EQ(rig.bridge.edid[56], 1280 & 0xff);
  EXPECT_EQ(rig.bridge.taken_width, 1280u);
  EXPECT_EQ(rig.mode.width, 1280);
  EXPECT_EQ(rig.mode.stride_bytes, 2560);
  EXPECT_EQ(rig.device.name(), std::string(32, 'x') + " at /dev/video0");
  EXPECT_EQ(rig.device.formats(), std::vector<PixelFormat>{PixelFormat::uyvy});
}

TEST(V4l2Device, AnEdidThatSomebodyWroteStays) {
  Rig rig;
  rig.bridge.edid.assign(256, 7);
  EXPECT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_EQ(rig.bridge.edid, std::vector<std::uint8_t>(256, 7));
}

TEST(V4l2Device, AGrabberThatKnowsNoTimingsNeedsNone) {
  Rig rig;
  for (const unsigned long request : {VIDIOC_G_EDID, VIDIOC_S_EDID, VIDIOC_QUERY_DV_TIMINGS})
    rig.bridge.refused[request] = -ENOTTY;
  rig.bridge.answered_width = 1280;
  EXPECT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_EQ(rig.bridge.taken_width, 0u);
}

TEST(V4l2Device, WhatIsWrongWithTheSignalIsToldApart) {
  const std::pair<int, VideoStatus> answers[] = {{-ENOLINK, VideoStatus::no_signal},
                                                 {-ENOLCK, VideoStatus::no_lock},
                                                 {-ERANGE, VideoStatus::out_of_range},
                                                 {-ENODEV, VideoStatus::absent},
                                                 {-EIO, VideoStatus::failed}};
  for (const auto& [error, status] : answers) {
    Rig rig;
    rig.bridge.refused[VIDIOC_QUERY_DV_TIMINGS] = error;
    EXPECT_EQ(rig.negotiate(), status) << error;
  }
  Rig rig;
  rig.bridge.interlaced = true;
  EXPECT_EQ(rig.negotiate(), VideoStatus::interlaced);
  for (const v4l2_field field : {V4L2_FIELD_INTERLACED, V4L2_FIELD_ALTERNATE, V4L2_FIELD_TOP}) {
    Rig composite;  // a grabber of S-Video, without timings
    composite.bridge.refused[VIDIOC_QUERY_DV_TIMINGS] = -ENOTTY;
    composite.bridge.answered_width = 720;
    composite.bridge.field = field;
    EXPECT_EQ(composite.negotiate(), VideoStatus::interlaced);
  }
  Rig busy;
  busy.bridge.refused[VIDIOC_S_DV_TIMINGS] = -EBUSY;
  EXPECT_EQ(busy.negotiate(), VideoStatus::busy);
}

TEST(V4l2Device, SaysTheRateThatItsGrabberGives) {
  Rig rig;
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_EQ(rig.mode.rate_hz, 60);
  rig.bridge.period = {1001, 5000};
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_NEAR(rig.mode.rate_hz, 4.995, 1e-3);
  rig.bridge.period = {0, 1};
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_EQ(rig.mode.rate_hz, 0) << "no rate at all";
  rig.bridge.refused[VIDIOC_S_PARM] = -ENOTTY;
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  EXPECT_EQ(rig.mode.rate_hz, 0) << "it does not say";
}

TEST(V4l2Device, AChangeOfSourceIsSaidBeforeItsPictures) {
  Rig rig;
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  ASSERT_EQ(rig.device.start(), VideoStatus::ok);
  VideoBuffer buffer;
  EXPECT_EQ(rig.device.take(buffer, Duration(0)), VideoStatus::nothing_yet);
  rig.bridge.said.push_back(filled(1, 100));
  rig.bridge.events = true;
  EXPECT_EQ(rig.device.take(buffer, Duration(0)), VideoStatus::changed);
  ASSERT_EQ(rig.device.take(buffer, Duration(0)), VideoStatus::ok);
  EXPECT_EQ(buffer.index, 1);
  EXPECT_EQ(buffer.bytes.size(), 100u);
  EXPECT_EQ(buffer.stamp_ns, 5'000'006'000);
  EXPECT_TRUE(buffer.monotonic);
  rig.device.close();
  EXPECT_EQ(rig.bridge.mapped, 0);
}

TEST(V4l2Device, ADeviceThatLiesAboutSizesGivesNoMoreThanItsMemory) {
  Rig rig;
  rig.bridge.buffer_bytes = 64;
  ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
  ASSERT_EQ(rig.device.start(), VideoStatus::ok);
  VideoBuffer buffer;
  rig.bridge.said.push_back(filled(2, 0xffffffff));
  ASSERT_EQ(rig.device.take(buffer, Duration(0)), VideoStatus::ok);
  EXPECT_EQ(std::count(buffer.bytes.begin(), buffer.bytes.end(), 2), 64);
  for (const std::uint32_t index : {4u, 1000u, 0xffffffffu}) {
    rig.bridge.said.push_back(filled(index, 10));
    EXPECT_EQ(rig.device.take(buffer, Duration(0)), VideoStatus::failed);
  }
  Rig absurd;
  absurd.bridge.answered_width = 0xfffffff0;
  EXPECT_EQ(absurd.negotiate(), VideoStatus::out_of_range);
  Rig endless;
  endless.bridge.offered = 0xffffffff;
  ASSERT_EQ(endless.device.open(), VideoStatus::ok);
  EXPECT_LE(endless.device.formats().size(), 64u);
}

TEST(V4l2Device, AStartThatFailsHalfwayLeavesNothingMapped) {
  for (int which = 0; which < 5; ++which) {
    Rig rig;
    ASSERT_EQ(rig.negotiate(), VideoStatus::ok);
    if (which == 0) rig.bridge.granted = 1;
    if (which == 1) rig.bridge.no_memory_at = 2;
    if (which == 2) rig.bridge.refused[VIDIOC_STREAMON] = -ENOSPC;
    if (which == 3) rig.bridge.refused[VIDIOC_QBUF] = -EINVAL;
    if (which == 4) rig.bridge.granted = 1000;
    EXPECT_EQ(rig.device.start(), which == 4 ? VideoStatus::ok : VideoStatus::failed);
    EXPECT_EQ(rig.bridge.mapped, which == 4 ? 4 : 0);
  }
}

TEST(V4l2Device, WhatIsNoGrabberIsNotTaken) {
  Rig metadata;
  metadata.bridge.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  EXPECT_EQ(metadata.device.open(), VideoStatus::absent);
  V4l2Device named("/dev/video0", metadata.bridge);
  EXPECT_EQ(named.open(), VideoStatus::not_video);
  Rig locked;
  locked.bridge.opening = -EACCES;
  EXPECT_EQ(locked.device.open(), VideoStatus::access_denied);
}

}  // namespace
}  // namespace sonoband
