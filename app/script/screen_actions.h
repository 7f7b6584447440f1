// What a finger does on the screen, as actions of a script. Their lines are described in script.h.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/script/words.h"
#include "core/time.h"
#include "ui/host/surface.h"
#include "ui/view.h"

namespace sonoband::script {

struct Tap {
  std::string widget;
  int times = 1;
};
struct Hold {
  std::string widget;
  Duration time{};
};
struct Drag {
  std::string widget;
  std::vector<ui::Vec2> way;  // two or more; parts of the widget, (0, 0) its top left corner
  Duration time{};
};
struct TwoFingers {
  std::string widget;
  float scale = 1;     // the picture grows so many times
  float turn_rad = 0;  // clockwise
};
struct KeyPress {
  ui::KeyEvent key;
};
struct Shot {
  std::string file;
};

// For somebody outside who works the board's own touchscreen.
struct Where {
  std::string widget;
};
struct AwaitPage {
  ui::Page page{};
  Duration at_most{};
};

using ScreenAction = std::variant<Tap, Hold, Drag, TwoFingers, KeyPress, Shot, Where, AwaitPage>;

// As scripts write it.
std::string_view name_of(ui::Page page);

// Empty when the line's verb is none of the screen's. Throws BadInput.
std::optional<ScreenAction> screen_action(const Place& place, const Words& words);

}  // namespace sonoband::script
