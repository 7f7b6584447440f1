#include "ui/host/window.h"

#include <GLES3/gl3.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "ui/gl.h"
#include "ui/host/x11_touch.h"

namespace sonoband::ui {

struct WindowSurface::State {
  ~State() {
    if (woken >= 0) close(woken);
  }

  GLFWwindow* window = nullptr;
  std::unique_ptr<X11Touch> touch;  // null where the server tells of no fingers
  int woken = -1;                   // can be read when another thread wants a frame
  Input* input = nullptr;           // while polling
  Stamp now{};
  Vec2 pointer;
  Vec2 sliding_from;
  bool finger = false;                               // left button
  bool sliding = false;                              // right button
  std::array<int, 4> windowed{100, 100, 1280, 800};  // place and size to come back to from full screen
};

namespace {

constexpr std::int32_t mouse = -1;  // its contact; no finger has this number

WindowSurface::State& state_of(GLFWwindow* window) {
  return *static_cast<WindowSurface::State*>(glfwGetWindowUserPointer(window));
}

// GLFW counts the mouse in screen units; with a scaled desktop a pixel is smaller.
Vec2 to_pixels(GLFWwindow* window, double x, double y) {
  int units_x = 1, units_y = 1, pixels_x = 1, pixels_y = 1;
  glfwGetWindowSize(window, &units_x, &units_y);
  glfwGetFramebufferSize(window, &pixels_x, &pixels_y);
  return {static_cast<float>(x * pixels_x / std::max(1, units_x)),
          static_cast<float>(y * pixels_y / std::max(1, units_y))};
}

void on_button(GLFWwindow* window, int button, int action, int) {
  WindowSurface::State& s = state_of(window);
  if (s.input == nullptr) return;
  if (button == GLFW_MOUSE_BUTTON_RIGHT) {
    s.sliding = action == GLFW_PRESS;
    s.sliding_from = s.pointer;
  }
  if (button != GLFW_MOUSE_BUTTON_LEFT) return;
  s.finger = action == GLFW_PRESS;
  s.input->contacts.push_back(
      {s.now, s.finger ? Contact::Kind::down : Contact::Kind::up, mouse, s.pointer, 0});
}

void on_move(GLFWwindow* window, double x, double y) {
  WindowSurface::State& s = state_of(window);
  const Vec2 before = s.pointer;
  s.pointer = to_pixels(window, x, y);
  if (s.input == nullptr) return;
  if (s.finger) s.input->contacts.push_back({s.now, Contact::Kind::move, mouse, s.pointer, 0});
  constexpr float pixels_per_notch = 40;
  if (s.sliding) {
    s.input->wheels.push_back({s.sliding_from, (1 / pixels_per_notch) * (s.pointer - before), false, true});
  }
}

void on_scroll(GLFWwindow* window, double x, double y) {
  WindowSurface::State& s = state_of(window);
  if (s.input == nullptr) return;
  const auto held = [&](int a, int b) {
    return glfwGetKey(window, a) == GLFW_PRESS || glfwGetKey(window, b) == GLFW_PRESS;
  };
  s.input->wheels.push_back({s.pointer,
                             {static_cast<float>(x), static_cast<float>(y)},
                             held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
                             held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT)});
}

void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
  WindowSurface::State& s = state_of(window);
  if (s.input == nullptr) return;
  KeyEvent event;
  event.down = action != GLFW_RELEASE;
  event.repeat = action == GLFW_REPEAT;
  event.control = (modifiers & GLFW_MOD_CONTROL) != 0;
  event.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
  constexpr std::array<std::pair<int, Key>, 14> named = {{
      {GLFW_KEY_BACKSPACE, Key::backspace},
      {GLFW_KEY_ENTER, Key::enter},
      {GLFW_KEY_KP_ENTER, Key::enter},
      {GLFW_KEY_ESCAPE, Key::escape},
      {GLFW_KEY_LEFT, Key::left},
      {GLFW_KEY_RIGHT, Key::right},
      {GLFW_KEY_UP, Key::up},
      {GLFW_KEY_DOWN, Key::down},
      {GLFW_KEY_PAGE_UP, Key::page_up},
      {GLFW_KEY_PAGE_DOWN, Key::page_down},
      {GLFW_KEY_HOME, Key::home},
      {GLFW_KEY_END, Key::end},
      {GLFW_KEY_F1, Key::f1},
      {GLFW_KEY_F11, Key::f11},
  }};
  for (const auto& [code, name] : named) {
    if (code != key) continue;
    event.key = name;
    s.input->keys.push_back(event);
    return;
  }
  // Text comes through on_character; here are the space bar, whose release counts, and shortcuts.
  if (key == GLFW_KEY_SPACE) {
    event.character = U' ';
    s.input->keys.push_back(event);
  } else if (event.control && key >= GLFW_KEY_A && key <= GLFW_KEY_Z) {
    event.character = static_cast<char32_t>(key - GLFW_KEY_A + 'a');
    s.input->keys.push_back(event);
  }
}

void on_character(GLFWwindow* window, unsigned character) {
  WindowSurface::State& s = state_of(window);
  if (s.input == nullptr || character == U' ') return;
  s.input->keys.push_back({Key::character, character, true, false, false, false});
}

// A finger that was down when the window lost the pointer would stay down for ever.
void on_focus(GLFWwindow* window, int focused) {
  WindowSurface::State& s = state_of(window);
  if (focused != 0 || s.input == nullptr) return;
  if (s.finger) s.input->contacts.push_back({s.now, Contact::Kind::up, mouse, s.pointer, 0});
  s.input->keys.push_back({Key::character, U' ', false, false, false, false});
  s.finger = s.sliding = false;
}

void on_close(GLFWwindow* window) {
  WindowSurface::State& s = state_of(window);
  if (s.input != nullptr) s.input->close = true;
}

void take_events(WindowSurface::State& s) {
  std::uint64_t times = 0;
  static_cast<void>(!read(s.woken, &times, sizeof times));  // nothing to read: not woken
  glfwPollEvents();
  if (s.touch) s.touch->take(s.input->contacts, s.now);
}

// GLFW's own waiting knows nothing of the fingers' connection.
void sleep_until_something(const WindowSurface::State& s, Duration wait) {
  std::array<pollfd, 3> files{{{X11Touch::windows_file(), POLLIN, 0}, {s.woken, POLLIN, 0}, {-1, POLLIN, 0}}};
  if (s.touch) files[2].fd = s.touch->file();
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(wait).count();
  poll(files.data(), files.size(), static_cast<int>(ms));
}

std::string last_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words == nullptr ? "no reason given" : words;
}

}  // namespace

WindowSurface::WindowSurface(const WindowSettings& settings) : state_(std::make_unique<State>()) {
  if (glfwInit() == GLFW_FALSE) {
    throw std::runtime_error("no window: " + last_error() + "; set DISPLAY, or start with --headless");
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
  GLFWmonitor* monitor = settings.full_screen ? glfwGetPrimaryMonitor() : nullptr;
  int width = settings.width;
  int height = settings.height;
  if (monitor != nullptr) {
    const GLFWvidmode* mode = glfwGetVideoMode(monitor);
    width = mode->width;
    height = mode->height;
  }
  state_->window = glfwCreateWindow(width, height, settings.title.c_str(), monitor, nullptr);
  if (state_->window == nullptr) {
    const std::string why = last_error();
    glfwTerminate();
    throw std::runtime_error("no window: " + why + "; OpenGL ES 3 through EGL is needed (libegl-mesa0)");
  }
  state_->windowed = {100, 100, settings.width, settings.height};
  glfwSetWindowUserPointer(state_->window, state_.get());
  glfwSetMouseButtonCallback(state_->window, on_button);
  glfwSetCursorPosCallback(state_->window, on_move);
  glfwSetScrollCallback(state_->window, on_scroll);
  glfwSetKeyCallback(state_->window, on_key);
  glfwSetCharCallback(state_->window, on_character);
  glfwSetWindowFocusCallback(state_->window, on_focus);
  glfwSetWindowCloseCallback(state_->window, on_close);
  glfwMakeContextCurrent(state_->window);
  glfwSwapInterval(1);
  state_->touch = X11Touch::on(state_->window);
  state_->woken = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
}

WindowSurface::~WindowSurface() {
  state_->touch.reset();
  glfwDestroyWindow(state_->window);
  glfwTerminate();
}

Vec2 WindowSurface::size_px() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(state_->window, &width, &height);
  return {static_cast<float>(width), static_cast<float>(height)};
}

void WindowSurface::poll(Input& input, Stamp now, Duration wait) {
  state_->input = &input;
  state_->now = now;
  take_events(*state_);
  if (input.empty() && wait > Duration::zero()) {
    sleep_until_something(*state_, wait);
    take_events(*state_);
  }
  state_->input = nullptr;
}

void WindowSurface::begin_frame() {
  glfwMakeContextCurrent(state_->window);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void WindowSurface::end_frame() {
  glfwSwapBuffers(state_->window);
}

Rgba WindowSurface::read() {
  const Vec2 size = size_px();
  return gl::read_pixels(static_cast<int>(size.x), static_cast<int>(size.y));
}

void WindowSurface::toggle_full_screen() {
  GLFWwindow* window = state_->window;
  std::array<int, 4>& place = state_->windowed;
  if (glfwGetWindowMonitor(window) != nullptr) {
    glfwSetWindowMonitor(window, nullptr, place[0], place[1], place[2], place[3], GLFW_DONT_CARE);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return;
  glfwGetWindowPos(window, &place[0], &place[1]);
  glfwGetWindowSize(window, &place[2], &place[3]);
  const GLFWvidmode* mode = glfwGetVideoMode(monitor);
  glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

Rect WindowSurface::panel_px() const {
  const Vec2 size = size_px();
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr || glfwGetWindowMonitor(state_->window) != nullptr) return {0, 0, size.x, size.y};
  int x = 0, y = 0, left = 0, top = 0;
  glfwGetWindowPos(state_->window, &x, &y);
  glfwGetMonitorPos(monitor, &left, &top);
  const GLFWvidmode* mode = glfwGetVideoMode(monitor);
  return {static_cast<float>(left - x), static_cast<float>(top - y), static_cast<float>(mode->width),
          static_cast<float>(mode->height)};
}

void WindowSurface::wake() {
  const std::uint64_t one = 1;
  // Refused only when it was woken 2^64 times and nobody has looked.
  static_cast<void>(!write(state_->woken, &one, sizeof one));
}

}  // namespace sonoband::ui
