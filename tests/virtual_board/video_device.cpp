#include "tests/virtual_board/video_device.h"

#include <algorithm>

namespace sonoband::virtual_board {
namespace {

// With the two bytes of header: 32 packets, the longest transfer that uvcvideo queues. A longer payload would
// be split over transfers, of which only the first has a header.
constexpr unsigned most_payload = 32 * 512;
constexpr Duration exposure = std::chrono::milliseconds(0);

}  // namespace

VideoUsbDevice::VideoUsbDevice(int width, int height, int rate_hz, Clock& clock, sim::PaintFrame paint)
    : width_(width),
      rate_hz_(rate_hz),
      clock_(clock),
      paint_(std::move(paint)),
      grey_(static_cast<std::size_t>(width * height)),
      picture_(static_cast<std::size_t>(2 * width * height), 128),
      sent_(picture_.size()) {
  const auto w = static_cast<unsigned>(width);
  const auto h = static_cast<unsigned>(height);
  const unsigned bytes = 2 * w * h;
  const unsigned interval = 10'000'000U / static_cast<unsigned>(rate_hz);
  const unsigned bits = bytes * 8 * static_cast<unsigned>(rate_hz);
  device_ = Fields()
                .u8(18)
                .u8(1)
                .u16(0x200)
                .u8(0xef)
                .u8(2)
                .u8(1)
                .u8(64)
                .u16(0x1d6b)
                .u16(0x0102)
                .u16(0x100)
                .u8(1)
                .u8(2)
                .u8(3)
                .u8(1)
                .out;

  const Bytes camera =
      Fields().u8(18).u8(0x24).u8(2).u8(1).u16(0x201).u8(0).u8(0).u16(0).u16(0).u16(0).u8(3).u16(0).u8(0).out;
  const Bytes output = Fields().u8(9).u8(0x24).u8(3).u8(2).u16(0x101).u8(0).u8(1).u8(0).out;
  const Bytes control = Fields()
                            .u8(13)
                            .u8(0x24)
                            .u8(1)
                            .u16(0x100)
                            .u16(static_cast<unsigned>(13 + camera.size() + output.size()))
                            .u32(48'000'000)
                            .u8(1)
                            .u8(1)
                            .out;
  const Bytes yuyv{0x59, 0x55, 0x59, 0x32, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71};
  const Bytes format =
      Fields().u8(27).u8(0x24).u8(4).u8(1).u8(1).bytes(yuyv).u8(16).u8(1).u8(0).u8(0).u8(0).u8(0).out;
  const Bytes frame = Fields()
                          .u8(30)
                          .u8(0x24)
                          .u8(5)
                          .u8(1)
                          .u8(0)
                          .u16(w)
                          .u16(h)
                          .u32(bits)
                          .u32(bits)
                          .u32(bytes)
                          .u32(interval)
                          .u8(1)
                          .u32(interval)
                          .out;
  const Bytes colour = Fields().u8(6).u8(0x24).u8(0x0d).u8(1).u8(1).u8(4).out;
  const Bytes input = Fields()
                          .u8(14)
                          .u8(0x24)
                          .u8(1)
                          .u8(1)
                          .u16(static_cast<unsigned>(14 + format.size() + frame.size() + colour.size()))
                          .u8(0x81)
                          .u8(0)
                          .u8(2)
                          .u8(0)
                          .u8(0)
                          .u8(0)
                          .u8(1)
                          .u8(0)
                          .out;
  Fields body;
  body.u8(8).u8(11).u8(0).u8(2).u8(14).u8(3).u8(0).u8(2);
  body.u8(9).u8(4).u8(0).u8(0).u8(0).u8(14).u8(1).u8(0).u8(0).bytes(control).bytes(camera).bytes(output);
  body.u8(9).u8(4).u8(1).u8(0).u8(1).u8(14).u8(2).u8(0).u8(0).bytes(input).bytes(format).bytes(frame).bytes(
      colour);
  body.u8(7).u8(5).u8(0x81).u8(2).u16(512).u8(0);
  configuration_ = Fields()
                       .u8(9)
                       .u8(2)
                       .u16(static_cast<unsigned>(9 + body.out.size()))
                       .u8(2)
                       .u8(1)
                       .u8(0)
                       .u8(0x80)
                       .u8(250)
                       .bytes(body.out)
                       .out;
}

Bytes VideoUsbDevice::string(int index) const {
  if (index == 0) return language_descriptor();
  if (index == 1) return string_descriptor("Sonoband");
  if (index == 2) return string_descriptor("Simulated scanner");
  return index == 3 ? string_descriptor("1") : Bytes{};
}

// Probe and commit controls: there is one mode, so there is one answer.
Bytes VideoUsbDevice::agreement() const {
  return Fields()
      .u16(1)
      .u8(1)
      .u8(1)
      .u32(10'000'000U / static_cast<unsigned>(rate_hz_))
      .u16(0)
      .u16(0)
      .u16(0)
      .u16(0)
      .u16(0)
      .u32(static_cast<unsigned>(picture_.size()))
      .u32(most_payload)
      .out;
}

std::optional<Bytes> VideoUsbDevice::class_request(const Setup& setup,
                                                   std::span<const std::uint8_t> /*data*/) {
  const bool streaming = (setup.request_type & 0x60) == 0x20 && (setup.index & 0xff) == 1;
  const int control = setup.value >> 8;
  if (!streaming || (control != 1 && control != 2)) return std::nullopt;
  switch (setup.request) {
    case 0x01:
      return Bytes{};
    case 0x81:
    case 0x82:
    case 0x83:
    case 0x87:
      return agreement();
    case 0x85:
      return Fields().u16(26).out;
    case 0x86:
      return Bytes{3};
    default:
      return std::nullopt;
  }
}

void VideoUsbDevice::paint_next() {
  paint_(clock_.now() - exposure, grey_.data(), width_);
  for (std::size_t i = 0; i < grey_.size(); ++i) picture_[2 * i] = grey_[i];
  sent_ = 0;
  frame_bit_ ^= 1;
}

std::optional<Bytes> VideoUsbDevice::bulk_in(std::size_t most) {
  if (most < 3) return Bytes{};
  if (sent_ == picture_.size()) {
    const Stamp now = clock_.now();
    if (stalled || now < next_) return std::nullopt;
    next_ = std::max(next_ + from_seconds(1.0 / rate_hz_), now);
    paint_next();
  }
  const std::size_t part = std::min({most, static_cast<std::size_t>(most_payload)}) - 2;
  const std::size_t n = std::min(part, picture_.size() - sent_);
  Bytes out{2, static_cast<std::uint8_t>(0x80 | frame_bit_ | (sent_ + n == picture_.size() ? 2 : 0))};
  out.insert(out.end(), picture_.begin() + static_cast<std::ptrdiff_t>(sent_),
             picture_.begin() + static_cast<std::ptrdiff_t>(sent_ + n));
  sent_ += n;
  return out;
}

}  // namespace sonoband::virtual_board
