// The seam to whatever a pedal's contacts are wired to: lines of a GPIO chip (gpio_contacts.h), keys of a USB
// pedal (key_contacts.h), or made-up edges in a test.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/time.h"

namespace sonoband {

enum class ContactStatus : std::uint8_t {
  ok,
  nothing_yet,
  overflow,       // edges were dropped: every level is to be read anew
  no_such_line,   // no chip has a line of this name; no such device
  access_denied,  // the operating system refuses (udev rule missing)
  busy,           // another process holds it
  no_bias,        // the controller cannot pull the line: leave the bias out and fit a resistor
  gone,           // unplugged
};

enum class Bias : std::uint8_t { as_is, pull_up, pull_down, off };

struct ContactRequest {
  std::string name;         // of the line, as the device tree names it; of a key, as KEY_A or BTN_0
  bool active_low = false;  // the contact pulls the line down
  Bias bias = Bias::as_is;
};

struct ContactEdge {
  int contact = 0;             // index into what was requested
  bool active = false;         // its level after the edge
  std::int64_t stamp_ns = 0;   // the kernel's, CLOCK_MONOTONIC
  std::uint32_t sequence = 0;  // of this contact, from 1; 0 where the kernel's is not to be had
};

class ContactSource {
 public:
  virtual ~ContactSource() = default;
  virtual ContactStatus open(std::span<const ContactRequest> contacts) = 0;
  virtual ContactStatus wait(ContactEdge& out, Duration timeout) = 0;
  virtual std::optional<bool> level(int contact) = 0;  // now; empty: gone
  virtual void close() = 0;                            // of a closed source: nothing to do
};

// Whether a name can be found on this machine, and what holds it: for people.
struct ContactReport {
  bool found = false;
  std::string where;  // chip and number, or device
};

}  // namespace sonoband
