#include "hal/capture/v4l2_device.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

namespace sonoband {
namespace {

int call(int fd, unsigned long request, void* argument) {
  int result = 0;
  do {
    result = ioctl(fd, request, argument);
  } while (result == -1 && errno == EINTR);
  return result;
}

VideoStatus status_of(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return VideoStatus::absent;
    case EACCES:
    case EPERM:
      return VideoStatus::access_denied;
    case EBUSY:
      return VideoStatus::busy;
    case EAGAIN:
      return VideoStatus::nothing_yet;
    case ENOLINK:
      return VideoStatus::no_signal;
    case ENOLCK:
      return VideoStatus::no_lock;
    case ERANGE:
      return VideoStatus::out_of_range;
    default:
      return VideoStatus::failed;
  }
}

struct Code {
  PixelFormat format;
  std::uint32_t fourcc;
};
constexpr Code codes[] = {{PixelFormat::grey8, V4L2_PIX_FMT_GREY},  {PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},
                          {PixelFormat::uyvy, V4L2_PIX_FMT_UYVY},   {PixelFormat::nv12, V4L2_PIX_FMT_NV12},
                          {PixelFormat::rgb24, V4L2_PIX_FMT_RGB24}, {PixelFormat::mjpeg, V4L2_PIX_FMT_MJPEG}};

constexpr int last_device = 63;

}  // namespace

V4l2Device::~V4l2Device() {
  V4l2Device::close();
}

VideoStatus V4l2Device::open() {
  if (fd_ >= 0) return VideoStatus::ok;
  if (path_ != "auto") return open_one(path_);
  VideoStatus best = VideoStatus::absent;
  for (int n = 0; n <= last_device; ++n) {
    const VideoStatus status = open_one("/dev/video" + std::to_string(n));
    if (status == VideoStatus::ok) return status;
    // A UVC grabber has a second device file for its metadata, which is none of ours.
    if (status != VideoStatus::absent && status != VideoStatus::not_video) best = status;
  }
  return best;
}

VideoStatus V4l2Device::open_one(const std::string& path) {
  fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return status_of(errno);
  v4l2_capability about{};
  const bool answers = call(fd_, VIDIOC_QUERYCAP, &about) == 0;
  const std::uint32_t able =
      (about.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? about.device_caps : about.capabilities;
  if (!answers || (able & V4L2_CAP_VIDEO_CAPTURE) == 0 || (able & V4L2_CAP_STREAMING) == 0) {
    close();
    return VideoStatus::not_video;
  }
  opened_ = path;
  card_.assign(reinterpret_cast<const char*>(about.card),
               strnlen(reinterpret_cast<const char*>(about.card), 32));
  v4l2_event_subscription changes{};
  changes.type = V4L2_EVENT_SOURCE_CHANGE;
  call(fd_, VIDIOC_SUBSCRIBE_EVENT, &changes);  // devices that cannot tell do not have to
  return VideoStatus::ok;
}

// An HDMI bridge says what its input is and has to be told to take it; other devices know nothing of timings.
VideoStatus V4l2Device::take_timings() {
  v4l2_dv_timings timings{};
  if (call(fd_, VIDIOC_QUERY_DV_TIMINGS, &timings) == 0)
    return call(fd_, VIDIOC_S_DV_TIMINGS, &timings) == 0 ? VideoStatus::ok : status_of(errno);
  if (errno == ENOTTY || errno == ENODATA || errno == EINVAL) return VideoStatus::ok;
  return status_of(errno);
}

std::vector<PixelFormat> V4l2Device::formats() {
  std::vector<PixelFormat> offered;
  v4l2_fmtdesc entry{};
  entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  constexpr std::uint32_t enough = 64;
  for (entry.index = 0; entry.index < enough && call(fd_, VIDIOC_ENUM_FMT, &entry) == 0; ++entry.index)
    for (const Code& c : codes)
      if (c.fourcc == entry.pixelformat) offered.push_back(c.format);
  return offered;
}

VideoStatus V4l2Device::negotiate(VideoMode& mode, double rate_hz) {
  if (const VideoStatus status = take_timings(); status != VideoStatus::ok) return status;
  v4l2_format wanted{};
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.fmt.pix.width = static_cast<std::uint32_t>(mode.width);
  wanted.fmt.pix.height = static_cast<std::uint32_t>(mode.height);
  wanted.fmt.pix.field = V4L2_FIELD_NONE;
  for (const Code& c : codes)
    if (c.format == mode.format) wanted.fmt.pix.pixelformat = c.fourcc;
  const std::uint32_t asked = wanted.fmt.pix.pixelformat;
  if (call(fd_, VIDIOC_S_FMT, &wanted) != 0) return status_of(errno);
  const v4l2_pix_format& got = wanted.fmt.pix;
  if (got.pixelformat != asked || got.width > 16384 || got.height > 16384) return VideoStatus::out_of_range;
  mode.width = static_cast<int>(got.width);
  mode.height = static_cast<int>(got.height);
  mode.stride_bytes = static_cast<std::ptrdiff_t>(got.bytesperline);
  mode.bytes = got.sizeimage;

  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  rate.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000 * rate_hz))};
  call(fd_, VIDIOC_S_PARM, &rate);  // many grabbers follow their input whatever is asked
  return VideoStatus::ok;
}

VideoStatus V4l2Device::start() {
  v4l2_requestbuffers request{};
  request.count = wanted_buffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (call(fd_, VIDIOC_REQBUFS, &request) != 0) return status_of(errno);
  streaming_ = true;  // from here on stop() has something to undo
  buffers_ = static_cast<int>(std::min<std::uint32_t>(request.count, wanted_buffers));
  if (buffers_ < 2) return stop(), VideoStatus::failed;
  for (int i = 0; i < buffers_; ++i) {
    v4l2_buffer b{};
    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    b.index = static_cast<std::uint32_t>(i);
    const auto failed = [&] {
      const VideoStatus why = status_of(errno);
      stop();
      return why;
    };
    if (call(fd_, VIDIOC_QUERYBUF, &b) != 0) return failed();
    void* start = mmap(nullptr, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, b.m.offset);
    if (start == MAP_FAILED) return failed();
    mapped_[static_cast<std::size_t>(i)] = {start, b.length};
    if (call(fd_, VIDIOC_QBUF, &b) != 0) return failed();
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (call(fd_, VIDIOC_STREAMON, &type) != 0) {
    const VideoStatus why = status_of(errno);
    stop();
    return why;
  }
  return VideoStatus::ok;
}

VideoStatus V4l2Device::take(VideoBuffer& out, Duration timeout) {
  pollfd ready{fd_, POLLIN | POLLPRI, 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  const int n = poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 10'000)));
  if (n == 0 || (n < 0 && errno == EINTR)) return VideoStatus::nothing_yet;
  if (n < 0) return VideoStatus::failed;
  if ((ready.revents & POLLPRI) != 0) {
    v4l2_event event{};
    if (call(fd_, VIDIOC_DQEVENT, &event) == 0 && event.type == V4L2_EVENT_SOURCE_CHANGE)
      return VideoStatus::changed;
  }
  if ((ready.revents & (POLLIN | POLLERR)) == 0) return VideoStatus::nothing_yet;
  v4l2_buffer b{};
  b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  b.memory = V4L2_MEMORY_MMAP;
  if (call(fd_, VIDIOC_DQBUF, &b) != 0) return status_of(errno);
  if (b.index >= static_cast<std::uint32_t>(buffers_)) return VideoStatus::failed;
  const Mapping& m = mapped_[b.index];
  out.index = static_cast<int>(b.index);
  out.bytes = {static_cast<const std::uint8_t*>(m.start), std::min<std::size_t>(b.bytesused, m.bytes)};
  out.sequence = b.sequence;
  out.stamp_ns = std::int64_t{b.timestamp.tv_sec} * 1'000'000'000 + std::int64_t{b.timestamp.tv_usec} * 1000;
  out.monotonic = (b.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  out.damaged = (b.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return VideoStatus::ok;
}

VideoStatus V4l2Device::give_back(int index) {
  v4l2_buffer b{};
  b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  b.memory = V4L2_MEMORY_MMAP;
  b.index = static_cast<std::uint32_t>(index);
  return call(fd_, VIDIOC_QBUF, &b) == 0 ? VideoStatus::ok : status_of(errno);
}

void V4l2Device::stop() {
  if (!streaming_) return;
  streaming_ = false;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  call(fd_, VIDIOC_STREAMOFF, &type);
  for (Mapping& m : mapped_) {
    if (m.start != nullptr) munmap(m.start, m.bytes);
    m = {};
  }
  buffers_ = 0;
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  call(fd_, VIDIOC_REQBUFS, &none);
}

void V4l2Device::close() {
  stop();
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

}  // namespace sonoband
