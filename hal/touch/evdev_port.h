// A touchscreen of the kernel's, taken away from everyone else: the window system would make a mouse of it.
#pragma once

#include <memory>

#include "hal/touch/touch_port.h"

namespace sonoband {

// `device` is an event device file (a link below /dev/input/by-id stays with its panel), or "auto" for the
// first one that lies on a display and tells where fingers are.
std::unique_ptr<TouchPort> evdev_port(std::string device);

}  // namespace sonoband
