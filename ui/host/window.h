// A window on X11 through GLFW, drawn with OpenGL ES 3 through EGL. Fingers come as the X server tells of
// them; the mouse is one more, its wheel and right button stand in for two (WheelEvent).
#pragma once

#include <memory>
#include <string>

#include "ui/host/surface.h"

namespace sonoband::ui {

struct WindowSettings {
  std::string title = "Sonoband";
  int width = 1280;
  int height = 800;
  bool full_screen = false;
};

// One at a time, on the thread that made it.
class WindowSurface final : public Surface {
 public:
  // Throws std::runtime_error with one sentence when there is no display or no OpenGL ES 3.
  explicit WindowSurface(const WindowSettings& settings);
  ~WindowSurface() override;
  WindowSurface(const WindowSurface&) = delete;
  WindowSurface& operator=(const WindowSurface&) = delete;

  Vec2 size_px() const override;
  void poll(Input& input, Stamp now, Duration wait) override;
  void begin_frame() override;
  void end_frame() override;  // waits for the display's refresh
  Rgba read() override;

  // Where the whole display lies in the window's pixels: all of them in full screen.
  Rect panel_px() const;
  void toggle_full_screen();
  void wake();  // ends a poll that waits; from any thread

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace sonoband::ui
