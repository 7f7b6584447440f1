#include "hal/capture/v4l2_device.h"

#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "hal/capture/edid.h"
#include "hal/capture/format_codes.h"

namespace sonoband {
namespace {

// Of a negative errno.
VideoStatus status_of(int error) {
  switch (-error) {
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

constexpr FormatCode codes[] = {
    {PixelFormat::grey8, V4L2_PIX_FMT_GREY},  {PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},
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
  fd_ = kernel_.open(path);
  if (fd_ < 0) return status_of(fd_);
  v4l2_capability about{};
  const bool answers = call(VIDIOC_QUERYCAP, &about) == 0;
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
  call(VIDIOC_SUBSCRIBE_EVENT, &changes);  // devices that cannot tell do not have to
  return VideoStatus::ok;
}

// A bridge that has no EDID, as after each power-up, gets one of the size that is wanted: without it the
// scanner sends nothing. One that somebody has written stays.
void V4l2Device::give_edid(const VideoMode& mode, double rate_hz) {
  std::array<std::uint8_t, 128> block{};
  v4l2_edid present{};
  present.blocks = 1;
  present.edid = block.data();
  const int result = call(VIDIOC_G_EDID, &present);
  const bool has_none = result == -ENODATA || (result == 0 && present.blocks == 0);
  if (!has_none) return;
  block = edid(mode.width, mode.height, rate_hz);
  if (block[1] == 0) return;
  v4l2_edid ours{};
  ours.blocks = 1;
  ours.edid = block.data();
  call(VIDIOC_S_EDID, &ours);
}

// An HDMI bridge says what its input is and has to be told to take it; other devices know nothing of timings.
VideoStatus V4l2Device::take_timings() {
  v4l2_dv_timings timings{};
  const int asked = call(VIDIOC_QUERY_DV_TIMINGS, &timings);
  if (asked == -ENOTTY || asked == -ENODATA || asked == -EINVAL) return VideoStatus::ok;
  if (asked < 0) return status_of(asked);
  // Lines of one field each would be paired as whole pictures.
  if (timings.bt.interlaced != V4L2_DV_PROGRESSIVE) return VideoStatus::interlaced;
  const int taken = call(VIDIOC_S_DV_TIMINGS, &timings);
  return taken < 0 ? status_of(taken) : VideoStatus::ok;
}

std::vector<PixelFormat> V4l2Device::formats() {
  std::vector<PixelFormat> offered;
  v4l2_fmtdesc entry{};
  entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  constexpr std::uint32_t enough = 64;
  for (entry.index = 0; entry.index < enough && call(VIDIOC_ENUM_FMT, &entry) == 0; ++entry.index)
    offer(entry.pixelformat, codes, offered);
  return offered;
}

VideoStatus V4l2Device::negotiate(VideoMode& mode, double rate_hz) {
  give_edid(mode, rate_hz);
  if (const VideoStatus status = take_timings(); status != VideoStatus::ok) return status;
  v4l2_format wanted{};
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.fmt.pix.width = static_cast<std::uint32_t>(mode.width);
  wanted.fmt.pix.height = static_cast<std::uint32_t>(mode.height);
  wanted.fmt.pix.field = V4L2_FIELD_NONE;
  const std::uint32_t asked = code_of(mode.format, codes);
  wanted.fmt.pix.pixelformat = asked;
  if (const int result = call(VIDIOC_S_FMT, &wanted); result < 0) return status_of(result);
  const v4l2_pix_format& got = wanted.fmt.pix;
  if (got.pixelformat != asked || got.width > largest_side_px || got.height > largest_side_px)
    return VideoStatus::out_of_range;
  // Of an interlaced picture every second row was taken 17 to 20 ms later: what moves is torn.
  if (got.field != V4L2_FIELD_NONE && got.field != V4L2_FIELD_ANY) return VideoStatus::interlaced;
  mode.width = static_cast<int>(got.width);
  mode.height = static_cast<int>(got.height);
  mode.stride_bytes = static_cast<std::ptrdiff_t>(got.bytesperline);
  mode.bytes = got.sizeimage;

  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  rate.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000 * rate_hz))};
  // Many grabbers follow their input whatever is asked, and do not say.
  const v4l2_fract& period = rate.parm.capture.timeperframe;
  const bool says = call(VIDIOC_S_PARM, &rate) == 0 && period.numerator > 0;
  mode.rate_hz = says ? static_cast<double>(period.denominator) / period.numerator : 0;
  return VideoStatus::ok;
}

VideoStatus V4l2Device::start() {
  v4l2_requestbuffers request{};
  request.count = wanted_buffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int result = call(VIDIOC_REQBUFS, &request); result < 0) return status_of(result);
  streaming_ = true;  // from here on stop() has something to undo
  buffers_ = static_cast<int>(std::min<std::uint32_t>(request.count, wanted_buffers));
  if (buffers_ < 2) return stop(), VideoStatus::failed;
  for (int i = 0; i < buffers_; ++i) {
    v4l2_buffer b{};
    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    b.index = static_cast<std::uint32_t>(i);
    int result = call(VIDIOC_QUERYBUF, &b);
    if (result < 0) return stop(), status_of(result);
    void* start = kernel_.map(fd_, b.length, b.m.offset);
    if (start == nullptr) return stop(), VideoStatus::failed;
    mapped_[static_cast<std::size_t>(i)] = {start, b.length};
    result = call(VIDIOC_QBUF, &b);
    if (result < 0) return stop(), status_of(result);
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int result = call(VIDIOC_STREAMON, &type); result < 0) return stop(), status_of(result);
  return VideoStatus::ok;
}

VideoStatus V4l2Device::take(VideoBuffer& out, Duration timeout) {
  const int ready = kernel_.wait(fd_, timeout);
  if (ready < 0) return VideoStatus::failed;
  if ((ready & POLLPRI) != 0) {
    v4l2_event event{};
    if (call(VIDIOC_DQEVENT, &event) == 0 && event.type == V4L2_EVENT_SOURCE_CHANGE)
      return VideoStatus::changed;
  }
  if ((ready & (POLLIN | POLLERR)) == 0) return VideoStatus::nothing_yet;
  v4l2_buffer b{};
  b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  b.memory = V4L2_MEMORY_MMAP;
  if (const int result = call(VIDIOC_DQBUF, &b); result < 0) return status_of(result);
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
  const int result = call(VIDIOC_QBUF, &b);
  return result < 0 ? status_of(result) : VideoStatus::ok;
}

void V4l2Device::stop() {
  if (!streaming_) return;
  streaming_ = false;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  call(VIDIOC_STREAMOFF, &type);
  for (Mapping& m : mapped_) {
    if (m.start != nullptr) kernel_.unmap(m.start, m.bytes);
    m = {};
  }
  buffers_ = 0;
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  call(VIDIOC_REQBUFS, &none);
}

void V4l2Device::close() {
  stop();
  if (fd_ >= 0) kernel_.close(fd_);
  fd_ = -1;
}

}  // namespace sonoband
