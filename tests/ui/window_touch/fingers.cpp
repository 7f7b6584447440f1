// Puts fingers on the touchscreen of Xorg's driver inputtest: fingers SOCKET, then lines on standard input,
//   down|move|up FINGER X Y     in pixels of a 1280 x 800 screen
//   wait SECONDS
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <xorg/xf86-input-inputtest-protocol.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <string>
#include <thread>

namespace {

constexpr double width_px = 1280;
constexpr double height_px = 800;
// Of the driver's axes (hw/xfree86/drivers/inputtest): absolute ones go from 0 to 0xffff.
constexpr double axis_units = 65535;

bool send_all(int to, const void* bytes, std::size_t size) {
  return write(to, bytes, size) == static_cast<ssize_t>(size);
}

template <class Event>
Event event_of(xf86ITEventType type) {
  Event event{};
  event.header.length = sizeof event;
  event.header.type = type;
  return event;
}

// The server has done all it was sent.
bool wait_for_server(int server) {
  const auto sync = event_of<xf86ITEventWaitForSync>(XF86IT_EVENT_WAIT_FOR_SYNC);
  xf86ITResponseSyncFinished done{};
  return send_all(server, &sync, sizeof sync) && read(server, &done, sizeof done) == sizeof done;
}

bool touch(int server, const std::string& what, unsigned finger, double x, double y) {
  static const std::map<std::string, std::uint32_t> kinds = {
      {"down", 18}, {"move", 19}, {"up", 20}};  // XI_Touch*
  auto event = event_of<xf86ITEventTouch>(XF86IT_EVENT_TOUCH);
  event.touchid = finger;
  event.touch_type = kinds.at(what);
  event.valuators.mask[0] = 0b11;
  event.valuators.valuators[0] = x / width_px * axis_units;
  event.valuators.valuators[1] = y / height_px * axis_units;
  return send_all(server, &event, sizeof event) && wait_for_server(server);
}

int connect_to(const char* path) {
  const int server = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  if (connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return -1;
  auto hello = event_of<xf86ITEventClientVersion>(XF86IT_EVENT_CLIENT_VERSION);
  hello.major = XF86IT_PROTOCOL_VERSION_MAJOR;
  hello.minor = XF86IT_PROTOCOL_VERSION_MINOR;
  xf86ITResponseServerVersion version{};
  const bool met = send_all(server, &hello, sizeof hello) && read(server, &version, sizeof version) > 0;
  return met ? server : -1;
}

}  // namespace

int main(int argc, char** argv) {
  const int server = argc == 2 ? connect_to(argv[1]) : -1;
  if (server < 0) {
    std::fprintf(stderr, "fingers: no touchscreen at the socket %s\n", argc == 2 ? argv[1] : "(none named)");
    return 1;
  }
  for (std::string what; std::cin >> what;) {
    if (what == "wait") {
      double s = 0;
      std::cin >> s;
      std::this_thread::sleep_for(std::chrono::duration<double>(s));
      continue;
    }
    unsigned finger = 0;
    double x = 0;
    double y = 0;
    std::cin >> finger >> x >> y;
    if (!std::cin || (what != "down" && what != "move" && what != "up") ||
        !touch(server, what, finger, x, y)) {
      std::fprintf(stderr, "fingers: the touchscreen does not take: %s\n", what.c_str());
      return 1;
    }
  }
  return 0;
}
