// A scripted examination: what an operator would do, one action a line, for headless runs and tests.
//
//   # comment
//   wait 1.5                                   seconds of the cart's clock
//   press                                      the record pedal goes down
//   release                                    ... and up
//   await review 10                            until the cart is in that state, at most so many seconds
//   watch                                      from here on say what the cart does (app/script/watch.h), each
//                                              sweep at its end and each picture, in lines of JSON
//   render thin.png                            a planar band of the last sweep
//   render thick.png thickness-mm=14 compounding=max
//     options: thickness-mm=T compounding=max|min|mean interpolation=nearest|linear view=NAME at=0..1
//              view: level or upright (core/reslice/default_plane.h; `at` says where), or one that the
//              simulated scene suggests, such as sagittal
//   manifold unrolled.png curve=x,y;x,y;... reach-mm=R [render's options]
//              curve: plane mm of the view, from its first pixel; curve and reach may be left to a scene that
//              suggests them
//
// With the screen, a finger works it, widgets by their names (every panel gives its widgets one: rail/live,
// reslice/picture, tools/curve):
//   tap tools/curve                            double-tap reslice/picture
//   hold review/picture 0.8                    a finger that stays; seconds
//   drag reslice/picture 0.2,0.5 0.8,0.4 1.0   from, over any number of places, in parts of the widget (0,0
//   its
//                                              top left corner); the last number is the seconds it takes
//   pinch reslice/picture 1.5                  the picture grows so many times
//   twist reslice/picture 30                   degrees, clockwise
//   key right                                  left right up down home end page-up page-down escape enter
//                                              backspace f1 f11, or one character
//   shot review.png                            a picture of the screen, in the --shots folder
//   where rail/exams                           says in a line of JSON where a finger would reach it, in parts
//                                              of the screen: {"widget":"rail/exams","x":0.03,"y":0.4}
//   await-page exams 60                        until that page is shown, at most so many seconds; then says
//                                              {"page":"exams"}. For a hand on the board's own touchscreen
// One such line, and the whole script runs with the screen, in memory; watch, render and manifold, which work
// without it, are then refused.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/script/screen_actions.h"
#include "core/reslice/band.h"

namespace sonoband::script {

struct Wait {
  Duration time{};
};
struct Press {};
struct Release {};
struct WatchCart {};
struct Await {
  std::string state;  // idle, live, recording or review
  Duration at_most{};
};
struct Render {
  std::string file;
  RenderSettings settings;
  std::string view = "upright";
  double at = 0.5;
};
struct Manifold {
  Render plane;                           // where the curve is drawn, and how the band is painted
  std::vector<Eigen::Vector2d> curve_mm;  // empty: the view's own
  std::optional<double> reach_mm;         // empty: the view's own
};

using Action = std::variant<Wait, Press, Release, Await, WatchCart, Render, Manifold, ScreenAction>;

struct Step {
  int line = 0;
  Action action;
};

// `file` names the script in sentences. Throws BadInput naming file, line and cure.
std::vector<Step> parse(std::string_view text, const std::string& file);
std::vector<Step> read(const std::string& file);

bool needs_screen(const std::vector<Step>& steps);

// The script asked for something that the cart or the screen did not do: what() names line, what was expected
// and what happened.
class ScriptFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The examination `sonoband --headless` runs without a script: wait, sweep, thin and thick bands.
std::string_view default_text();

}  // namespace sonoband::script
