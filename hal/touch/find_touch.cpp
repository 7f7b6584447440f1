#include "hal/touch/find_touch.h"

#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <unistd.h>

namespace sonoband {

std::string find_touch() {
  constexpr int last_event_device = 63;
  std::string found;
  for (int n = 0; n <= last_event_device && found.empty(); ++n) {
    const std::string path = "/dev/input/event" + std::to_string(n);
    const int fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) continue;
    libevdev* device = nullptr;
    if (libevdev_new_from_fd(fd, &device) == 0) {
      if (libevdev_has_event_code(device, EV_ABS, ABS_MT_POSITION_X) != 0 &&
          libevdev_has_property(device, INPUT_PROP_DIRECT) != 0)
        found = std::string(libevdev_get_name(device)) + " at " + path;
      libevdev_free(device);
    }
    ::close(fd);
  }
  return found;
}

}  // namespace sonoband
