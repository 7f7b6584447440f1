// The kernel's input devices as files: touchscreens, and pedals that act as keyboards.
#pragma once

#include <string>
#include <vector>

namespace sonoband {

std::vector<std::string> event_devices();  // /dev/input/event0 and so on, in the kernel's order

}  // namespace sonoband
