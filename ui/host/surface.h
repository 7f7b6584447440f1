// Where a frame goes and where fingers and keys come from. A window and a picture in memory are equals.
#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "ui/gesture.h"
#include "ui/rect.h"

namespace sonoband::ui {

enum class Key : std::uint8_t {
  character,  // KeyEvent::character
  backspace,
  enter,
  escape,
  left,
  right,
  up,
  down,
  page_up,
  page_down,
  home,
  end,
  f1,
  f11,
};

struct KeyEvent {
  Key key = Key::character;
  char32_t character = 0;  // the space bar is told as ' ', with its release
  bool down = true;
  bool repeat = false;
  bool control = false;
  bool shift = false;
};

// The mouse's wheel, or its right button dragged: what two fingers would do.
struct WheelEvent {
  Vec2 at;
  Vec2 step;  // notches; y positive away from the user
  bool control = false;
  bool shift = false;
};

// What happened since the last frame, in order within each kind.
struct Input {
  std::vector<Contact> contacts;
  std::vector<KeyEvent> keys;
  std::vector<WheelEvent> wheels;
  bool close = false;

  bool empty() const { return contacts.empty() && keys.empty() && wheels.empty() && !close; }
  void clear();
};

// 4 bytes a pixel (red, green, blue, 255), rows from the top, packed.
struct Rgba {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;
};

class Surface {
 public:
  virtual ~Surface() = default;
  virtual Vec2 size_px() const = 0;
  // Adds what happened to `input`; waits up to `wait` for the first thing to happen. Contacts are stamped
  // `now` where the system gives no time.
  virtual void poll(Input& input, Stamp now, Duration wait) = 0;
  virtual void begin_frame() = 0;  // its GL context and framebuffer are current afterwards
  virtual void end_frame() = 0;
  virtual Rgba read() = 0;  // what was drawn; between begin_frame and end_frame
};

}  // namespace sonoband::ui
