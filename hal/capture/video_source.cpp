#include "hal/capture/video_source.h"

#include <algorithm>
#include <utility>

#include "hal/capture/agreement.h"
#include "hal/capture/luma.h"

namespace sonoband {
namespace {

constexpr Duration look_again = std::chrono::seconds(1);
constexpr int max_silent_restarts = 3;
constexpr Duration believable_age = std::chrono::seconds(1);
constexpr std::uint32_t most_lost = 1000;  // a longer jump is a count that began anew

const char* sentence(VideoStatus status) {
  switch (status) {
    case VideoStatus::absent:
      return "No video grabber: check its USB cable and that capture.device names it.";
    case VideoStatus::access_denied:
      return "The video grabber may not be opened: install the udev rules of board/ and plug it in again.";
    case VideoStatus::busy:
      return "Another program holds the video grabber: close it.";
    case VideoStatus::not_video:
      return "capture.device is no device that streams pictures: name the grabber's.";
    case VideoStatus::no_signal:
      return "The grabber gets no signal: check the video cable and that the scanner is on.";
    case VideoStatus::no_lock:
      return "The grabber cannot lock to the scanner's signal: use a shorter video cable.";
    case VideoStatus::out_of_range:
      return "The grabber cannot take the scanner's video mode: choose another one on the scanner.";
    case VideoStatus::interlaced:
      return "The scanner's video is interlaced, which tears what moves: choose a progressive mode (p, not "
             "i) on "
             "the scanner.";
    case VideoStatus::no_colour:
      return "The grabber gives no colour that Doppler can be taken from: use one with YUYV, UYVY, RGB or "
             "motion JPEG, or set capture.colour to grey.";
    case VideoStatus::changed:
      return "The scanner changed its video mode; asking again what it sends.";
    default:
      return "The video grabber fails: unplug it and plug it in again.";
  }
}

DeviceState state_for(VideoStatus status) {
  switch (status) {
    case VideoStatus::absent:
      return DeviceState::absent;
    case VideoStatus::no_signal:
    case VideoStatus::changed:
    case VideoStatus::no_lock:
      return DeviceState::stalled;
    default:
      return DeviceState::fault;
  }
}

// What is wrong with pictures that do come.
const char* complaint(const VideoMode& mode, bool slow) {
  if (mode.format == PixelFormat::mjpeg)
    return "The grabber compresses its pictures (motion JPEG), which blurs edges: use one that does not.";
  if (slow)
    return "The grabber gives fewer pictures a second than capture.rate-hz: plug it into a USB 3 port, or "
           "correct that.";
  return "";
}

}  // namespace

VideoSource::VideoSource(VideoDevice& device, Clock& clock, const VideoSettings& settings)
    : device_(device),
      clock_(clock),
      settings_(settings),
      decoded_(settings.colour ? Pixels() : Pixels(settings.width, settings.height)),
      decoded_rgb_(settings.colour ? std::size_t{3} * settings.width * settings.height : 0) {}

VideoSource::~VideoSource() {
  VideoSource::stop();
}

void VideoSource::start() {
  if (started_) return;
  started_ = true;
  ever_streamed_ = false;
  counts_ = false;
  next_open_ = clock_.now();
  health_.delivered = 0;
  health_.say(DeviceState::starting, "");
}

void VideoSource::stop() {
  started_ = false;
  close();
  health_.say(DeviceState::absent, "");
}

void VideoSource::close() {
  if (state_ == State::streaming) device_.stop();
  device_.close();
  state_ = State::closed;
  held_ = -1;
}

VideoStatus VideoSource::bring_up() {
  if (const VideoStatus opened = device_.open(); opened != VideoStatus::ok) return opened;
  const Agreement agreed = agree(device_, {.width = settings_.width,
                                           .height = settings_.height,
                                           .rate_hz = settings_.rate_hz,
                                           .colour = settings_.colour});
  if (agreed.status != VideoStatus::ok) return agreed.status;
  if (const VideoStatus started = device_.start(); started != VideoStatus::ok) return started;
  mode_ = agreed.mode;
  complaint_ = complaint(agreed.mode, agreed.slow);
  state_ = State::streaming;
  last_frame_ = clock_.now();
  last_sequence_.reset();
  return VideoStatus::ok;
}

void VideoSource::trouble(VideoStatus why) {
  if (ever_streamed_ && state_ == State::streaming)
    health_.recoveries.fetch_add(1, std::memory_order_relaxed);
  close();
  health_.say(state_for(why), sentence(why));
  // A changed source is asked at once, everything else is looked for once a second; so is one that says
  // "changed" again and again without a picture between, as with a loose cable.
  const bool at_once = why == VideoStatus::changed && std::exchange(picture_since_change_, false);
  next_open_ = clock_.now() + (at_once ? Duration(0) : look_again);
}

// Of a grabber that does not count its frames the stamps alone tell two from one shown twice. Frames come a
// little early and late; half the time between them is neither.
bool VideoSource::is_later(const VideoBuffer& buffer) const {
  return static_cast<double>(buffer.stamp_ns - last_device_ns_) >= 0.5e9 / settings_.rate_hz;
}

bool VideoSource::decode(const VideoBuffer& buffer, Frame& out) {
  const int channels = settings_.colour ? 3 : 1;
  out.format = settings_.colour ? PixelFormat::rgb24 : PixelFormat::grey8;
  out.data = settings_.colour ? decoded_rgb_.data() : decoded_.view().data;
  out.stride_bytes = std::ptrdiff_t{channels} * out.width;
  out.bytes = static_cast<std::size_t>(out.stride_bytes) * static_cast<std::size_t>(out.height);
  if (out.width != settings_.width || out.height != settings_.height) return false;
  return settings_.colour ? jpeg_.decode_rgb(buffer.bytes, out.width, out.height, decoded_rgb_.data())
                          : jpeg_.decode(buffer.bytes, decoded_.view());
}

bool VideoSource::accept(const VideoBuffer& buffer, Frame& out) {
  const Stamp now = clock_.now();
  std::uint64_t missed = 0;
  if (last_sequence_) {
    const std::uint32_t step = buffer.sequence - *last_sequence_;
    if (step == 0 && (counts_ || !is_later(buffer))) return false;  // the same frame twice
    counts_ = counts_ || step != 0;
    if (step != 0 && step <= most_lost) missed = step - 1;
  }
  last_sequence_ = buffer.sequence;
  last_device_ns_ = buffer.stamp_ns;
  sequence_ += missed + 1;
  health_.lost.fetch_add(missed, std::memory_order_relaxed);

  out = {};
  out.data = buffer.bytes.data();
  out.bytes = buffer.bytes.size();
  out.width = mode_->width;
  out.height = mode_->height;
  out.stride_bytes = mode_->stride_bytes;
  out.format = mode_->format;
  bool whole = !buffer.damaged;
  if (whole && out.format == PixelFormat::mjpeg) whole = decode(buffer, out);
  if (!whole || check_frame(out, settings_.width, settings_.height) != FrameFault::none) {
    health_.lost.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  out.arrived = now;
  out.device_stamp_ns = buffer.stamp_ns;
  const Stamp stamp{std::chrono::nanoseconds(buffer.stamp_ns)};
  // A stamp from another clock, or from the future, is none.
  const bool believable = buffer.monotonic && stamp <= now && now - stamp < believable_age;
  out.captured = believable ? stamp : now;
  if (last_stamp_ && out.captured <= *last_stamp_) out.captured = *last_stamp_ + Duration(1);
  last_stamp_ = out.captured;
  out.sequence = sequence_;
  return true;
}

ReadStatus VideoSource::read(Frame& out, Duration timeout) {
  if (!started_) return ReadStatus::ended;
  const Stamp until = clock_.now() + timeout;
  if (held_ >= 0) {
    if (device_.give_back(held_) != VideoStatus::ok) trouble(VideoStatus::failed);
    held_ = -1;
  }
  do {
    if (state_ == State::closed) {
      const Stamp now = clock_.now();
      if (now < next_open_) {
        clock_.sleep_until(std::min(until, next_open_));
        continue;
      }
      if (const VideoStatus status = bring_up(); status != VideoStatus::ok) {
        device_.close();
        health_.say(state_for(status), sentence(status));
        next_open_ = clock_.now() + look_again;
        continue;
      }
    }
    VideoBuffer buffer;
    const Stamp watch = last_frame_ + settings_.silent;
    const Stamp now = clock_.now();
    const VideoStatus status = device_.take(buffer, std::max(Duration(0), std::min(until, watch) - now));
    if (status == VideoStatus::ok) {
      if (accept(buffer, out)) {
        last_frame_ = clock_.now();
        silent_restarts_ = 0;
        ever_streamed_ = true;
        picture_since_change_ = true;
        held_ = buffer.index;
        health_.delivered.fetch_add(1, std::memory_order_relaxed);
        health_.say(*complaint_ == 0 ? DeviceState::running : DeviceState::degraded, complaint_);
        return ReadStatus::ok;
      }
      if (device_.give_back(buffer.index) != VideoStatus::ok) trouble(VideoStatus::failed);
    } else if (status != VideoStatus::nothing_yet) {
      trouble(status);
    }
    // Also one that sends a lot, but nothing that is a new picture.
    if (state_ == State::streaming && clock_.now() >= watch) {
      health_.recoveries.fetch_add(1, std::memory_order_relaxed);
      health_.say(DeviceState::stalled, "The video grabber sends no pictures; restarting it.");
      device_.stop();
      state_ = State::closed;
      last_sequence_.reset();
      if (++silent_restarts_ % max_silent_restarts == 0) device_.close();
      next_open_ = clock_.now();
    }
  } while (clock_.now() < until);
  return ReadStatus::nothing_yet;
}

DeviceHealth VideoSource::health() const {
  return health_.read();
}

}  // namespace sonoband
