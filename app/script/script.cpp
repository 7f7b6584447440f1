#include "app/script/script.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "app/bad_input.h"
#include "app/script/words.h"

namespace sonoband::script {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

void take_compounding(const Place& place, const std::string& value, Render& render) {
  if (value == "max") {
    render.settings.compounding = Compounding::maximum;
  } else if (value == "min") {
    render.settings.compounding = Compounding::minimum;
  } else if (value == "mean") {
    render.settings.compounding = Compounding::mean;
  } else {
    place.refuse("compounding must be max, min or mean, not '" + value + "'");
  }
}

void take_interpolation(const Place& place, const std::string& value, Render& render) {
  if (value != "nearest" && value != "linear") {
    place.refuse("interpolation must be nearest or linear, not '" + value + "'");
  }
  render.settings.interpolation = value == "linear" ? Interpolation::linear : Interpolation::nearest;
}

// False when render has no such option.
bool take_option(const Place& place, const std::string& name, const std::string& value, Render& render) {
  if (name == "thickness-mm") {
    render.settings.band.thickness_mm = number_in(place, name, value, 0, 200);
  } else if (name == "compounding") {
    take_compounding(place, value, render);
  } else if (name == "interpolation") {
    take_interpolation(place, value, render);
  } else if (name == "view") {
    render.view = value;
  } else if (name == "at") {
    render.at = number_in(place, name, value, 0, 1);
  } else {
    return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> take_curve(const Place& place, const std::string& value) {
  std::vector<Eigen::Vector2d> points;
  for (const std::string& point : split(value, ';')) {
    const auto xy = split(point, ',');
    if (xy.size() != 2) place.refuse("curve must be x,y;x,y;... in mm of the plane, not '" + point + "'");
    points.push_back(
        {number_in(place, "x", xy[0], -10000, 10000), number_in(place, "y", xy[1], -10000, 10000)});
  }
  if (points.size() < 2) place.refuse("curve needs at least two points");
  return points;
}

std::pair<std::string, std::string> option(const Place& place, const std::string& word) {
  const auto equals = word.find('=');
  if (equals == std::string::npos)
    place.refuse("'" + word + "' is no option; options are written name=value");
  return {word.substr(0, equals), word.substr(equals + 1)};
}

Action render_action(const Place& place, const Words& words) {
  Render render;
  render.file = picture_file(place, words);
  for (std::size_t i = 2; i < words.size(); ++i) {
    const auto [name, value] = option(place, words[i]);
    if (!take_option(place, name, value, render)) place.refuse("render has no option " + name);
  }
  return render;
}

Action manifold_action(const Place& place, const Words& words) {
  Manifold manifold;
  manifold.plane.file = picture_file(place, words);
  for (std::size_t i = 2; i < words.size(); ++i) {
    const auto [name, value] = option(place, words[i]);
    if (name == "curve") {
      manifold.curve_mm = take_curve(place, value);
    } else if (name == "reach-mm") {
      manifold.reach_mm = number_in(place, name, value, 0.1, 500);
    } else if (!take_option(place, name, value, manifold.plane)) {
      place.refuse("manifold has no option " + name);
    }
  }
  return manifold;
}

Action await_action(const Place& place, const Words& words) {
  if (words.size() != 3) place.refuse("await needs a state and seconds, for example: await review 10");
  const std::string& state = words[1];
  if (state != "idle" && state != "live" && state != "recording" && state != "review") {
    place.refuse("the states are idle, live, recording and review, not '" + state + "'");
  }
  return Await{state, from_seconds(number_in(place, "seconds", words[2], 0, 3600))};
}

Action action(const Place& place, const Words& words) {
  const std::string& verb = words[0];
  if ((verb == "press" || verb == "release" || verb == "watch") && words.size() > 1)
    place.refuse(verb + " stands alone on its line");
  if (verb == "press") return Press{};
  if (verb == "release") return Release{};
  if (verb == "watch") return WatchCart{};
  if (verb == "await") return await_action(place, words);
  if (verb == "render") return render_action(place, words);
  if (verb == "manifold") return manifold_action(place, words);
  if (verb == "wait") {
    if (words.size() != 2) place.refuse("wait needs seconds, for example: wait 1.5");
    return Wait{from_seconds(number_in(place, "seconds", words[1], 0, 3600))};
  }
  if (const auto on_screen = screen_action(place, words)) return *on_screen;
  place.refuse("there is no action '" + verb +
               "'; there are wait, press, release, await, watch, render and manifold, and with the screen "
               "tap, double-tap, hold, drag, pinch, twist, key, shot, where and await-page");
}

}  // namespace

std::vector<Step> parse(std::string_view text, const std::string& file) {
  std::vector<Step> steps;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream in(line.substr(0, line.find('#')));
    const Words words{std::istream_iterator<std::string>(in), {}};
    if (!words.empty()) steps.push_back({number, action(Place{file, number}, words)});
  }
  if (!needs_screen(steps)) return steps;
  for (const Step& step : steps) {
    if (std::holds_alternative<Render>(step.action) || std::holds_alternative<Manifold>(step.action))
      Place{file, step.line}.refuse("render and manifold work without the screen; take a shot instead");
    if (std::holds_alternative<WatchCart>(step.action))
      Place{file, step.line}.refuse("watch works without the screen; take a shot instead");
  }
  return steps;
}

bool needs_screen(const std::vector<Step>& steps) {
  return std::any_of(steps.begin(), steps.end(),
                     [](const Step& step) { return std::holds_alternative<ScreenAction>(step.action); });
}

std::vector<Step> read(const std::string& file) {
  std::ifstream in;
  if (std::filesystem::is_regular_file(file)) in.open(file, std::ios::binary);
  if (!in.is_open()) throw BadInput(file + ": this script cannot be read; name one that exists");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse(text, file);
}

}  // namespace sonoband::script
