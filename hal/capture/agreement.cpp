#include "hal/capture/agreement.h"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace sonoband {
namespace {

constexpr double near_enough = 0.9;  // 59.94 Hz for 60, not 50

constexpr PixelFormat for_grey[] = {PixelFormat::grey8, PixelFormat::nv12,  PixelFormat::yuyv,
                                    PixelFormat::uyvy,  PixelFormat::rgb24, PixelFormat::mjpeg};
constexpr PixelFormat for_colour[] = {PixelFormat::rgb24, PixelFormat::yuyv, PixelFormat::uyvy,
                                      PixelFormat::mjpeg};

std::span<const PixelFormat> best_first(bool colour) {
  return colour ? std::span<const PixelFormat>(for_colour) : std::span<const PixelFormat>(for_grey);
}

// Of one format. Another size is out of range.
VideoStatus ask(VideoDevice& device, const VideoWish& wish, PixelFormat format, VideoMode& mode) {
  mode = {.format = format, .width = wish.width, .height = wish.height};
  const VideoStatus status = device.negotiate(mode, wish.rate_hz);
  if (status != VideoStatus::ok) return status;
  const bool as_asked = mode.format == format && mode.width == wish.width && mode.height == wish.height;
  return as_asked ? VideoStatus::ok : VideoStatus::out_of_range;
}

}  // namespace

Agreement agree(VideoDevice& device, const VideoWish& wish) {
  const std::vector<PixelFormat> offered = device.formats();
  Agreement result;
  if (wish.colour && !offered.empty()) result.status = VideoStatus::no_colour;
  std::optional<VideoMode> fastest;
  for (const PixelFormat format : best_first(wish.colour)) {
    if (std::find(offered.begin(), offered.end(), format) == offered.end()) continue;
    result.status = ask(device, wish, format, result.mode);
    if (result.status == VideoStatus::out_of_range || result.status == VideoStatus::failed) continue;
    if (result.status != VideoStatus::ok) return result;
    if (result.mode.rate_hz == 0 || result.mode.rate_hz >= near_enough * wish.rate_hz) return result;
    if (!fastest || result.mode.rate_hz > fastest->rate_hz) fastest = result.mode;
  }
  if (!fastest) return result;
  result.status = ask(device, wish, fastest->format, result.mode);
  result.slow = true;
  return result;
}

}  // namespace sonoband
