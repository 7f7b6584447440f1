// The scanner's video as a USB camera (UVC 1.0, YUYV, bulk): the simulated scene's pictures.
#pragma once

#include <atomic>

#include "hal/clock.h"
#include "hal/sim/sim_frame_source.h"
#include "tests/virtual_board/usb_device.h"

namespace sonoband::virtual_board {

class VideoUsbDevice final : public UsbDevice {
 public:
  // `paint` gives grey8.
  VideoUsbDevice(int width, int height, int rate_hz, Clock& clock, sim::PaintFrame paint);

  const Bytes& device_descriptor() const override { return device_; }
  const Bytes& configuration() const override { return configuration_; }
  Bytes string(int index) const override;
  std::optional<Bytes> class_request(const Setup& setup, std::span<const std::uint8_t> data) override;
  void plugged() override {}
  void unplugged() override {}
  std::optional<Bytes> bulk_in(std::size_t most) override;
  void bulk_out(std::span<const std::uint8_t> /*bytes*/) override {}

  // While true no frame begins.
  std::atomic<bool> stalled{false};

 private:
  Bytes agreement() const;
  void paint_next();

  int width_;
  int rate_hz_;
  Clock& clock_;
  sim::PaintFrame paint_;
  Bytes device_;
  Bytes configuration_;
  Bytes grey_;
  Bytes picture_;
  std::size_t sent_ = 0;
  std::uint8_t frame_bit_ = 0;
  Stamp next_{};
};

}  // namespace sonoband::virtual_board
