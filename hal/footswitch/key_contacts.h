// USB pedals, which act as keyboards: their keys, taken away from everyone else so that none reaches the
// screen.
#pragma once

#include "hal/footswitch/contact_source.h"

namespace sonoband {

struct PedalUsbId {
  int vendor = 0;
  int product = 0;
};
std::span<const PedalUsbId> known_pedals();  // board/udev/ has a rule for each

// `device` is an event device file (a link below /dev/input/by-id stays with its pedal), or "auto" for the
// first one whose product id is that of a known pedal and that has the keys asked for: a pedal that is a
// mouse as well has two event devices.
std::unique_ptr<ContactSource> key_contacts(std::string device);

ContactReport find_key_pedal(const std::string& device, std::span<const ContactRequest> keys);

}  // namespace sonoband
