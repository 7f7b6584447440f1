// Traces of touchscreens in evemu's format: its lines N (name), A (axis) and E (event).
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "hal/clock.h"
#include "hal/touch/touch_port.h"

namespace sonoband::test {

struct TouchTrace {
  TouchPanel panel;
  std::vector<RawTouch> events;  // stamp_ns from the trace's start
};

// NAME.evemu of tests/hal/touch/traces. Throws std::runtime_error for a file that is not there or is no
// trace.
TouchTrace read_touch_trace(const std::string& name);

// Plays a trace on the clock from its opening on; unplugged when it is over.
std::unique_ptr<TouchPort> trace_port(TouchTrace trace, Clock& clock);

}  // namespace sonoband::test
