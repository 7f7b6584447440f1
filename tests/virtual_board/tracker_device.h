// A LIBERTY or VIPER on the simulated USB: the wire-level simulator of hal/sim behind its endpoints.
#pragma once

#include <memory>
#include <mutex>

#include "hal/clock.h"
#include "hal/sim/liberty_sim.h"
#include "hal/sim/viper_sim.h"
#include "tests/virtual_board/usb_device.h"

namespace sonoband::virtual_board {

class TrackerDevice final : public UsbDevice {
 public:
  // `product` is ff20 (LIBERTY), bf01 (VIPER), or another id of the vendor, for a wrong device.
  TrackerDevice(std::uint16_t product, Clock& clock, const sim::ProbePose& hand);

  const Bytes& device_descriptor() const override { return device_; }
  const Bytes& configuration() const override { return configuration_; }
  Bytes string(int index) const override;
  std::optional<Bytes> class_request(const Setup& setup, std::span<const std::uint8_t> data) override;
  void plugged() override;
  void unplugged() override;
  std::optional<Bytes> bulk_in(std::size_t most) override;
  void bulk_out(std::span<const std::uint8_t> bytes) override;

 private:
  Bytes device_;
  Bytes configuration_;
  bool viper_;
  std::unique_ptr<sim::TrackerBus> bus_;
  std::mutex mutex_;  // bulk_in and bulk_out come from two threads
};

}  // namespace sonoband::virtual_board
