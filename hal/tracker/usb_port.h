// The tracker's plug: a byte port over USB bulk transfers, several of which are always queued, so that no
// packet has to wait for the host. Cancelling often loses data on poor devices: transfers have no time limit
// and are only cancelled to close.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "hal/tracker/byte_port.h"
#include "hal/tracker/usb_calls.h"

namespace sonoband {

constexpr std::uint16_t polhemus_vendor = 0x0f44;

// What a product id of that vendor is.
struct UsbProduct {
  std::uint16_t id = 0;
  const char* name = "";
  bool loader = false;  // waits for its firmware
  TrackerFamily family = TrackerFamily::liberty;
  std::uint8_t out = 0;  // endpoints; 0: the first bulk one
  std::uint8_t in = 0;
};
const UsbProduct* find_product(std::uint16_t id);  // null for one that is no tracker known here

// The two of `bulk` (addresses as the device has them) that this product is talked to by. Empty where it has
// them not: then it is not what its id says.
struct UsbEndpoints {
  std::uint8_t out = 0;
  std::uint8_t in = 0;
};
std::optional<UsbEndpoints> endpoints_of(const UsbProduct& product, std::span<const std::uint8_t> bulk);

class UsbPort final : public BytePort {
 public:
  explicit UsbPort(std::unique_ptr<UsbCalls> calls) : calls_(std::move(calls)) {}
  ~UsbPort() override;

  PortState open() override;
  TrackerFamily family() const override {
    return product_ == nullptr ? TrackerFamily::liberty : product_->family;
  }
  Transfer write(std::span<const std::uint8_t> bytes) override;
  Transfer read(std::span<std::uint8_t> into, Duration timeout) override;
  void clear_halt() override;
  void close(Closing how) override;

 private:
  static constexpr std::size_t queued = 4;
  // A multiple of every packet size there is: else a full packet overflows the transfer and is lost.
  static constexpr std::size_t transfer_bytes = 4096;

  bool queue_all();

  std::unique_ptr<UsbCalls> calls_;
  const UsbProduct* product_ = nullptr;  // of the open port
  UsbEndpoints endpoints_;
  bool halted_ = false;
  bool gone_ = false;
  std::array<std::array<std::uint8_t, transfer_bytes>, queued> buffers_{};
};

}  // namespace sonoband
