// The lines of --check about devices, each over the seam of its driver.
#pragma once

#include <string>

#include "board/check.h"
#include "hal/capture/video_device.h"
#include "hal/footswitch/contact_source.h"
#include "hal/touch/touch_port.h"
#include "hal/tracker/usb_calls.h"

namespace sonoband {

// Each opens the device as its driver would, starts nothing, and leaves it closed.
CheckLine tracker_line(UsbCalls& usb);
CheckLine video_line(VideoDevice& device, const Profile& profile);
// `where` the contacts of the profile are on this machine, for people; empty: nowhere.
CheckLine pedal_line(ContactSource& contacts, const Profile& profile, const std::string& where);
// No touchscreen is a warning: a mouse does everything as well.
CheckLine touch_line(TouchPort& port, const Profile& profile);

}  // namespace sonoband
