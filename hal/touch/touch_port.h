// The seam to a touchscreen's events: the kernel's event device (evdev_port.h), a simulated panel
// (hal/sim/sim_panel.h), or what a test writes.
#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"

namespace sonoband {

enum class TouchStatus : std::uint8_t {
  ok,
  nothing_yet,
  absent,         // no touchscreen; no such device
  access_denied,  // the operating system refuses (udev rule missing)
  busy,           // another program has grabbed it
  gone,           // unplugged
};

// One event in the kernel's words (linux/input-event-codes.h).
struct RawTouch {
  std::uint16_t type = 0;
  std::uint16_t code = 0;
  std::int32_t value = 0;
  std::int64_t stamp_ns = 0;  // CLOCK_MONOTONIC; 0 where the kernel's is on another clock
};

// Of one axis, in the panel's own units.
struct TouchRange {
  std::int32_t least = 0;
  std::int32_t most = 0;
  double per_mm = 0;  // units in a millimetre; 0 where the panel does not say
};

struct TouchPanel {
  std::string name;
  std::string path;
  enum class Protocol : std::uint8_t {
    slots,    // multi-touch B: each finger has a slot, changes are told
    packets,  // multi-touch A: every packet tells all fingers anew
    single,   // one finger, as a pointer
  } protocol = Protocol::slots;
  TouchRange x, y;
  TouchRange major;  // of the contact's longer axis; least == most: not told
};

class TouchPort {
 public:
  virtual ~TouchPort() = default;
  // Takes the panel for itself. Afterwards wait first tells what each slot held when it was opened (the
  // kernel tells only changes), but no contact: a finger that was already down counts from its next landing.
  virtual TouchStatus open(TouchPanel& panel) = 0;
  // After SYN_DROPPED (events were lost) come those that lead to the present state.
  virtual TouchStatus wait(RawTouch& out, Duration timeout) = 0;
  virtual void close() = 0;  // of a closed port: nothing to do
};

}  // namespace sonoband
