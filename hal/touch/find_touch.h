#pragma once

#include <string>

namespace sonoband {

// Name and device file of the first touchscreen on this machine; empty if there is none or none may be read.
// The window system reads the screen; this is for the check only.
std::string find_touch();

}  // namespace sonoband
