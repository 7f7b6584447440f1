// A scripted examination: what an operator would do, one action a line, for headless runs and tests.
//
//   # comment
//   wait 1.5                                   seconds of the cart's clock
//   press                                      the record pedal goes down
//   release                                    ... and up
//   await review 10                            until the cart is in that state, at most so many seconds
//   render thin.png                            a planar band of the last sweep through its middle
//   render thick.png thickness-mm=14 compounding=max
//     options: thickness-mm=T compounding=max|min|mean interpolation=nearest|linear depth=0..1 size=WxH
//     pixel-mm=P
//              depth: where the plane lies between the probe (0) and the bottom of the picture (1), usually
//              0.5
//   manifold unrolled.png curve=x,y;x,y;... reach-mm=R [render's options]
//              curve: plane mm of render's plane, from its first pixel
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/reslice/band.h"
#include "core/reslice/default_plane.h"

namespace sonoband::script {

struct Wait {
  Duration time{};
};
struct Press {};
struct Release {};
struct Await {
  std::string state;  // idle, live, recording or review
  Duration at_most{};
};
struct Render {
  std::string file;
  RenderSettings settings;
  PlaneView view = PlaneView::upright;
  double at = 0.5;
};
struct Manifold {
  Render plane;  // where the curve is drawn, and how the band is painted
  std::vector<std::array<double, 2>> curve_mm;
  double reach_mm = 20;
};

using Action = std::variant<Wait, Press, Release, Await, Render, Manifold>;

struct Step {
  int line = 0;
  Action action;
};

// `file` names the script in sentences. Throws BadInput naming file, line and cure.
std::vector<Step> parse(std::string_view text, const std::string& file);
std::vector<Step> read(const std::string& file);

// The examination `sonoband --headless` runs without a script: wait, sweep, thin and thick bands.
std::string_view default_text();

}  // namespace sonoband::script
