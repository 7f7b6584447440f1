// Serves one simulated USB device over usbredir, the protocol by which QEMU (-device usb-redir) takes devices
// from elsewhere. Everything the peer says is checked: it ends the connection when it does not fit.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "tests/virtual_board/usb_device.h"

namespace sonoband::virtual_board {

// The protocol's messages, without sockets: bytes in, bytes out. A transfer that has to wait for the device
// is answered by pump().
class RedirSession {
 public:
  explicit RedirSession(UsbDevice& device);

  // False when the peer broke the protocol: the session is over.
  bool hear(std::span<const std::uint8_t> bytes, Bytes& out);
  // Answers a waiting transfer if the device has something for it; false: it has not.
  bool pump(Bytes& out);
  bool waiting() const { return !pending_.empty(); }

 private:
  struct Pending {
    std::uint64_t id = 0;
    std::uint8_t endpoint = 0;
    std::size_t length = 0;
  };
  bool handle(std::uint32_t type, std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out);
  void announce(Bytes& out);
  bool control(std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out);
  bool bulk(std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out);
  std::optional<Bytes> standard_request(const Setup& setup);
  void say(std::uint32_t type, std::uint64_t id, std::span<const std::uint8_t> body, Bytes& out) const;

  UsbDevice& device_;
  Bytes heard_;
  bool said_hello_ = false;
  bool greeted_ = false;  // the peer said it
  std::deque<Pending> pending_;
};

// Listens on a Unix socket and serves whoever connects, one at a time, until `stop`. While `unplugged` is
// true a connection is closed and none is taken.
void serve(UsbDevice& device, const std::string& socket_path, const std::atomic<bool>& stop,
           const std::atomic<bool>& unplugged);

}  // namespace sonoband::virtual_board
