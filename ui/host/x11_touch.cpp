#include "ui/host/x11_touch.h"

#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3native.h>

#include <array>
#include <chrono>
#include <cstdint>

namespace sonoband::ui {

struct X11Touch::State {
  Display* display = nullptr;
  int opcode = 0;
  ~State() {
    if (display != nullptr) XCloseDisplay(display);
  }
};

namespace {

// The server's clock has 32 bits: the last moment with those.
Stamp stamp_of(unsigned long server_ms, Stamp now) {
  using std::chrono::milliseconds;
  const auto now_ms = std::chrono::floor<milliseconds>(now.time_since_epoch()).count();
  const auto age = static_cast<std::uint32_t>(now_ms) - static_cast<std::uint32_t>(server_ms);
  constexpr std::uint32_t believable_ms = 1000;  // older: the server's clock is another one
  return age <= believable_ms ? Stamp(milliseconds(now_ms - age)) : now;
}

// Apart from the numbers of a touchscreen that the board reads itself, and from the mouse's.
std::int32_t contact_of(int touch) {
  return -2 - (touch & 0xffffff);
}

}  // namespace

X11Touch::X11Touch(std::unique_ptr<State> state) : state_(std::move(state)) {}

X11Touch::~X11Touch() = default;

std::unique_ptr<X11Touch> X11Touch::on(GLFWwindow* window) {
  auto state = std::make_unique<State>();
  state->display = XOpenDisplay(XDisplayString(glfwGetX11Display()));
  if (state->display == nullptr) return nullptr;
  int event = 0;
  int error = 0;
  int major = 2;
  int minor = 2;
  if (XQueryExtension(state->display, "XInputExtension", &state->opcode, &event, &error) == 0) return nullptr;
  if (XIQueryVersion(state->display, &major, &minor) != Success || major * 100 + minor < 202) return nullptr;
  std::array<unsigned char, XIMaskLen(XI_TouchEnd)> bits{};
  for (const int type : {XI_TouchBegin, XI_TouchUpdate, XI_TouchEnd}) XISetMask(bits.data(), type);
  XIEventMask mask{XIAllMasterDevices, static_cast<int>(bits.size()), bits.data()};
  XISelectEvents(state->display, glfwGetX11Window(window), &mask, 1);
  XSync(state->display, 0);
  return std::unique_ptr<X11Touch>(new X11Touch(std::move(state)));
}

void X11Touch::take(std::vector<Contact>& contacts, Stamp now) {
  while (XPending(state_->display) > 0) {
    XEvent event;
    XNextEvent(state_->display, &event);
    XGenericEventCookie& cookie = event.xcookie;
    if (event.type != GenericEvent || cookie.extension != state_->opcode) continue;
    if (XGetEventData(state_->display, &cookie) == 0) continue;
    const auto& touch = *static_cast<const XIDeviceEvent*>(cookie.data);
    const auto kind = cookie.evtype == XI_TouchBegin    ? Contact::Kind::down
                      : cookie.evtype == XI_TouchUpdate ? Contact::Kind::move
                                                        : Contact::Kind::up;
    const Vec2 at{static_cast<float>(touch.event_x), static_cast<float>(touch.event_y)};
    contacts.push_back({stamp_of(touch.time, now), kind, contact_of(touch.detail), at, 0});
    XFreeEventData(state_->display, &cookie);
  }
}

int X11Touch::file() const {
  return ConnectionNumber(state_->display);
}

int X11Touch::windows_file() {
  return ConnectionNumber(glfwGetX11Display());
}

}  // namespace sonoband::ui
