// A scripted hand on the screen: what a finger would do, one action a line, widgets by their names.
//
//   # comment
//   wait 1.5                       seconds of the cart's clock
//   press, release                 the pedal
//   await review 10                until the cart is idle, live, recording or in review; at most so many seconds
//   tap tools/curve
//   double-tap reslice/picture
//   hold review/picture 0.8        a finger that stays; seconds
//   drag reslice/picture 0.2,0.5 0.8,0.4 1.0    from, over any number of points, in parts of the widget (0,0 its
//                                               top left corner); the last number is the seconds it takes
//   pinch reslice/picture 1.5      the picture grows so many times
//   twist reslice/picture 30       degrees, clockwise
//   key right                      left right up down home end page-up page-down escape enter backspace f1 f11, or
//                                  one character
//   shot review.png                a picture of the screen, in the --shots folder
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/time.h"
#include "ui/host/surface.h"

namespace sonoband::screen_script {

struct Wait {
  Duration time{};
};
struct Pedal {
  bool down = false;
};
struct Await {
  std::string state;
  Duration at_most{};
};
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
  std::vector<ui::Vec2> way;  // parts of the widget
  Duration time{};
};
struct Pinch {
  std::string widget;
  float scale = 1;
  float turn_rad = 0;
};
struct KeyPress {
  ui::KeyEvent key;
};
struct Shot {
  std::string file;
};

using Action = std::variant<Wait, Pedal, Await, Tap, Hold, Drag, Pinch, KeyPress, Shot>;

struct Step {
  int line = 0;
  Action action;
};

// `file` names the script in sentences. Throws BadInput naming file, line and cure.
std::vector<Step> parse(std::string_view text, const std::string& file);

}  // namespace sonoband::screen_script
