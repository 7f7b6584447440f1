#include "hal/capture/camera_device.h"

#include <algorithm>
#include <utility>

#include "hal/capture/format_codes.h"

namespace sonoband {
namespace {

constexpr std::uint32_t fourcc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 8 |
         static_cast<std::uint32_t>(c) << 16 | static_cast<std::uint32_t>(d) << 24;
}

// DRM names packed colours from the highest bit of a little-endian word: its BGR888 has red in the first
// byte.
constexpr FormatCode codes[] = {
    {PixelFormat::grey8, fourcc('R', '8', ' ', ' ')}, {PixelFormat::yuyv, fourcc('Y', 'U', 'Y', 'V')},
    {PixelFormat::uyvy, fourcc('U', 'Y', 'V', 'Y')},  {PixelFormat::nv12, fourcc('N', 'V', '1', '2')},
    {PixelFormat::rgb24, fourcc('B', 'G', '2', '4')}, {PixelFormat::mjpeg, fourcc('M', 'J', 'P', 'G')}};

constexpr std::size_t fewest_buffers = 2;

VideoStatus status_of(CameraError error) {
  switch (error) {
    case CameraError::none:
      return VideoStatus::ok;
    case CameraError::absent:
      return VideoStatus::absent;
    case CameraError::busy:
      return VideoStatus::busy;
    case CameraError::refused:
      return VideoStatus::out_of_range;
    default:
      return VideoStatus::failed;
  }
}

}  // namespace

CameraDevice::CameraDevice(std::unique_ptr<CameraCalls> calls, std::string id)
    : calls_(std::move(calls)), id_(std::move(id)) {}

CameraDevice::~CameraDevice() {
  CameraDevice::close();
}

VideoStatus CameraDevice::open() {
  if (open_) return VideoStatus::ok;
  const CameraError error = calls_->open(id_);
  open_ = error == CameraError::none;
  return status_of(error);
}

std::string CameraDevice::name() const {
  return open_ ? calls_->name() + " of libcamera" : "";
}

std::vector<PixelFormat> CameraDevice::formats() {
  std::vector<PixelFormat> offered;
  for (const std::uint32_t fourcc : calls_->formats()) offer(fourcc, codes, offered);
  return offered;
}

VideoStatus CameraDevice::negotiate(VideoMode& mode, double rate_hz) {
  CameraMode asked{.width = static_cast<unsigned>(mode.width), .height = static_cast<unsigned>(mode.height)};
  asked.fourcc = code_of(mode.format, codes);
  CameraMode got = asked;
  if (const CameraError error = calls_->configure(got); error != CameraError::none) return status_of(error);
  if (got.fourcc != asked.fourcc || got.width > largest_side_px || got.height > largest_side_px)
    return VideoStatus::out_of_range;
  mode.width = static_cast<int>(got.width);
  mode.height = static_cast<int>(got.height);
  mode.stride_bytes = static_cast<std::ptrdiff_t>(got.stride_bytes);
  mode.bytes = got.bytes;
  rate_hz_ = rate_hz;
  return VideoStatus::ok;
}

VideoStatus CameraDevice::start() {
  const CameraError error = calls_->start(rate_hz_, buffers_);
  streaming_ = true;  // from here on stop() has something to undo
  lent_.assign(buffers_.size(), false);
  if (error == CameraError::none && buffers_.size() >= fewest_buffers) return VideoStatus::ok;
  stop();
  return error == CameraError::none ? VideoStatus::failed : status_of(error);
}

VideoStatus CameraDevice::take(VideoBuffer& out, Duration timeout) {
  CameraCompletion done;
  if (!calls_->wait(done, timeout)) return calls_->gone() ? VideoStatus::absent : VideoStatus::nothing_yet;
  if (calls_->gone()) return VideoStatus::absent;
  const auto slot = static_cast<std::size_t>(done.slot);
  // A buffer that it never had is being read, or was never made.
  if (done.slot < 0 || slot >= buffers_.size() || lent_[slot]) return VideoStatus::failed;
  lent_[slot] = true;
  out.index = done.slot;
  out.bytes = buffers_[slot].first(std::min(done.bytes, buffers_[slot].size()));
  out.sequence = done.sequence;
  out.stamp_ns = done.stamp_ns;
  out.monotonic = true;
  out.damaged = !done.whole;
  return VideoStatus::ok;
}

VideoStatus CameraDevice::give_back(int index) {
  const auto slot = static_cast<std::size_t>(index);
  if (index < 0 || slot >= lent_.size() || !lent_[slot]) return VideoStatus::failed;
  lent_[slot] = false;
  return status_of(calls_->queue(index));
}

void CameraDevice::stop() {
  if (!std::exchange(streaming_, false)) return;
  calls_->stop();
  buffers_.clear();
  lent_.clear();
}

void CameraDevice::close() {
  stop();
  if (std::exchange(open_, false)) calls_->close();
}

}  // namespace sonoband
