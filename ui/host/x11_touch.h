// Fingers as the X server tells of them (XInput 2.2), on a connection of their own: GLFW knows no touch, and
// of fingers that somebody has asked for the server makes no mouse.
#pragma once

#include <memory>
#include <vector>

#include "ui/gesture.h"

struct GLFWwindow;

namespace sonoband::ui {

class X11Touch {
 public:
  // Null where the server tells of no fingers.
  static std::unique_ptr<X11Touch> on(GLFWwindow* window);
  ~X11Touch();
  X11Touch(const X11Touch&) = delete;
  X11Touch& operator=(const X11Touch&) = delete;

  // Adds what has come. The server's stamps are milliseconds of the clock of `now`.
  void take(std::vector<Contact>& contacts, Stamp now);
  int file() const;  // can be read when fingers have come

  // Can be read when something else has happened to a window.
  static int windows_file();

 private:
  struct State;
  explicit X11Touch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoband::ui
