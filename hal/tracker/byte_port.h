// The seam between the tracker's link and USB: bytes out, bytes in, and the state of the plug. Behind it are
// the libusb port and the wire-level simulator; nothing above it knows which.
//
// Threads: one thread uses a port, from the first open to the last close.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/time.h"

namespace sonoband {

enum class PortState : std::uint8_t {
  open,
  absent,         // no known device on the bus
  loader,         // the device is there with its loader's product id: it waits for its firmware
  access_denied,  // the operating system refuses (udev rule missing)
  busy,           // another process holds it
  stranger,       // a device of the vendor's, or one that says so, that is no tracker known here
  gone,           // was open, left the bus; counts as closed until open() is called again
};

enum class TransferStatus : std::uint8_t {
  ok,
  timed_out,
  stalled,  // the endpoint is halted until clear_halt
  io_error,
  gone,
};

// Which protocol the device speaks, by its product id.
enum class TrackerFamily : std::uint8_t {
  liberty,  // LIBERTY, PATRIOT
  viper,
};

// `count` bytes went over the wire whatever the status: a read that timed out may still have brought some.
struct Transfer {
  TransferStatus status = TransferStatus::ok;
  std::size_t count = 0;
};

class BytePort {
 public:
  virtual ~BytePort() = default;

  // Looks for the device and opens it. Cheap enough to be called once a second while it fails; an open port
  // stays open.
  virtual PortState open() = 0;

  // Of the open port.
  virtual TrackerFamily family() const = 0;

  // All of `bytes` or an error; waits at most a second. Needs an open port, as the next two do.
  virtual Transfer write(std::span<const std::uint8_t> bytes) = 0;

  // Returns as soon as there is anything, zero-length packets included (ok with a count of 0), or when
  // `timeout` is over. `into` holds at least 4096 bytes, so that no packet can overflow it.
  virtual Transfer read(std::span<std::uint8_t> into, Duration timeout) = 0;

  // Clears the halt of both endpoints after a stall.
  virtual void clear_halt() = 0;

  enum class Closing : std::uint8_t {
    release,
    reset
  };                                    // reset: a USB reset on the way, to wake a hung device
  virtual void close(Closing how) = 0;  // of a closed port: nothing to do
};

}  // namespace sonoband
