// The seam to libusb: the few calls that the tracker's port needs. Behind it are libusb (libusb_calls.cpp)
// and, in tests, a bus of made-up answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/time.h"

namespace sonoband {

enum class UsbError : std::uint8_t {
  none,
  access,  // the operating system refuses
  busy,    // another process holds the interface
  no_device,
  pipe,  // the endpoint is halted
  timeout,
  cancelled,
  other,  // input/output, overflow and the rest
};

// A transfer that is over. `count` bytes came whatever the error.
struct UsbCompletion {
  int slot = 0;
  UsbError error = UsbError::none;
  std::size_t count = 0;
};

class UsbCalls {
 public:
  virtual ~UsbCalls() = default;

  // Product ids of the vendor's devices on the bus. Cheap while nothing is plugged or unplugged.
  virtual std::vector<std::uint16_t> present(std::uint16_t vendor) = 0;
  // Opens the first of that product and claims its interface 0.
  virtual UsbError open(std::uint16_t vendor, std::uint16_t product) = 0;
  // Addresses of the bulk endpoints of the open device's interface 0, as its descriptor has them in order.
  virtual std::vector<std::uint8_t> bulk_endpoints() = 0;

  // Queues a transfer without a time limit. `into` lives until the transfer is over.
  virtual UsbError submit(int slot, std::uint8_t endpoint, std::span<std::uint8_t> into) = 0;
  // True with the next transfer that is over, oldest first; false when the time is.
  virtual bool wait(UsbCompletion& out, Duration timeout) = 0;
  virtual void cancel_all() = 0;  // returns when no transfer is queued; completions not taken are forgotten
  virtual UsbError write(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, Duration timeout,
                         std::size_t& count) = 0;
  virtual UsbError clear_halt(std::uint8_t endpoint) = 0;
  virtual void reset() = 0;
  virtual void close() = 0;  // after cancel_all
};

std::unique_ptr<UsbCalls> libusb_calls();

}  // namespace sonoband
