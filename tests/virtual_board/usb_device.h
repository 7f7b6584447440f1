// A simulated USB device as usbredir serves it: descriptors, control requests, bulk transfers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sonoband::virtual_board {

using Bytes = std::vector<std::uint8_t>;

struct Setup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  virtual const Bytes& device_descriptor() const = 0;
  virtual const Bytes& configuration() const = 0;
  virtual Bytes string(int index) const = 0;  // descriptor; empty: none
  // A class request; empty: refused.
  virtual std::optional<Bytes> class_request(const Setup& setup, std::span<const std::uint8_t> data) = 0;

  virtual void plugged() = 0;    // a host is there
  virtual void unplugged() = 0;  // it is not
  // Bytes for a bulk IN transfer of at most `most`, without waiting for them. Empty: none yet.
  virtual std::optional<Bytes> bulk_in(std::size_t most) = 0;
  virtual void bulk_out(std::span<const std::uint8_t> bytes) = 0;
};

// Little-endian descriptor fields, one after the other.
class Fields {
 public:
  Fields& u8(unsigned v) { return put(v, 1); }
  Fields& u16(unsigned v) { return put(v, 2); }
  Fields& u32(unsigned v) { return put(v, 4); }
  Fields& bytes(std::span<const std::uint8_t> b) {
    out.insert(out.end(), b.begin(), b.end());
    return *this;
  }
  Bytes out;

 private:
  Fields& put(unsigned v, int n) {
    for (int i = 0; i < n; ++i) out.push_back(static_cast<std::uint8_t>(v >> 8 * i));
    return *this;
  }
};

Bytes string_descriptor(const char* ascii);
Bytes language_descriptor();

}  // namespace sonoband::virtual_board
