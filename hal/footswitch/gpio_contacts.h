// Pedals on GPIO lines, by libgpiod 1.6 or 2 (one .cpp each, chosen when the project is configured).
#pragma once

#include "hal/footswitch/contact_source.h"

namespace sonoband {

// Lines are found by name on any chip: numbers differ from board to board and from kernel to kernel. Edges
// are raw: the kernel's own debounce stamps at the end of the quiet period.
std::unique_ptr<ContactSource> gpio_contacts();

ContactReport find_gpio_line(const std::string& name);

}  // namespace sonoband
