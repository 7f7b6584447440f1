// virtual-touch: a touchscreen of 1280 x 800 on the virtual board, made by the kernel's uinput. Reads one
// action a line and says it when it is done: down X Y, move X Y, up, quit. The screen goes away with this
// program.
#include <fcntl.h>
#include <libevdev/libevdev-uinput.h>
#include <libevdev/libevdev.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>

namespace {

constexpr int width_px = 1280;
constexpr int height_px = 800;

void enable_axis(libevdev* device, unsigned axis, int most, int per_mm) {
  input_absinfo range{};
  range.maximum = most;
  range.resolution = per_mm;
  libevdev_enable_event_code(device, EV_ABS, axis, &range);
}

libevdev* touchscreen() {
  constexpr int per_mm = 6;  // a screen of 10 inches
  libevdev* device = libevdev_new();
  libevdev_set_name(device, "Virtual touchscreen");
  libevdev_set_id_bustype(device, BUS_USB);
  libevdev_enable_property(device, INPUT_PROP_DIRECT);
  libevdev_enable_event_type(device, EV_KEY);
  libevdev_enable_event_code(device, EV_KEY, BTN_TOUCH, nullptr);
  libevdev_enable_event_type(device, EV_ABS);
  enable_axis(device, ABS_X, width_px - 1, per_mm);
  enable_axis(device, ABS_Y, height_px - 1, per_mm);
  enable_axis(device, ABS_MT_SLOT, 9, 0);
  enable_axis(device, ABS_MT_TRACKING_ID, 65535, 0);
  enable_axis(device, ABS_MT_POSITION_X, width_px - 1, per_mm);
  enable_axis(device, ABS_MT_POSITION_Y, height_px - 1, per_mm);
  return device;
}

}  // namespace

int main() {
  libevdev_uinput* screen = nullptr;
  const int failed = libevdev_uinput_create_from_device(touchscreen(), LIBEVDEV_UINPUT_OPEN_MANAGED, &screen);
  if (failed != 0) {
    std::fprintf(stderr, "virtual-touch: /dev/uinput makes no device (error %d)\n", -failed);
    return 1;
  }
  std::printf("%s\n", libevdev_uinput_get_devnode(screen));
  std::fflush(stdout);
  const auto say = [&](unsigned type, unsigned code, int value) {
    libevdev_uinput_write_event(screen, type, code, value);
  };
  int finger = 0;
  for (std::string line; std::getline(std::cin, line) && line != "quit";) {
    std::istringstream in(line);
    std::string word;
    int x = 0;
    int y = 0;
    in >> word >> x >> y;
    if (word == "down" || word == "up") {
      say(EV_ABS, ABS_MT_TRACKING_ID, word == "down" ? ++finger : -1);
      say(EV_KEY, BTN_TOUCH, word == "down" ? 1 : 0);
    }
    if (word != "up") {
      say(EV_ABS, ABS_MT_POSITION_X, x);
      say(EV_ABS, ABS_MT_POSITION_Y, y);
      say(EV_ABS, ABS_X, x);
      say(EV_ABS, ABS_Y, y);
    }
    say(EV_SYN, SYN_REPORT, 0);
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }
  libevdev_uinput_destroy(screen);
  return 0;
}
