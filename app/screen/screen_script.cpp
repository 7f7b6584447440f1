#include "app/screen/screen_script.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

#include "app/bad_input.h"

namespace sonoband::screen_script {
namespace {

class LineReader {
 public:
  LineReader(const std::string& line, const std::string& file, int number) : words_(line), file_(file), number_(number) {}

  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(file_ + ":" + std::to_string(number_) + ": " + why);
  }
  std::optional<std::string> word() {
    std::string w;
    if (!(words_ >> w) || w.starts_with('#')) return std::nullopt;
    return w;
  }
  std::string need(const std::string& what) {
    if (auto w = word()) return *w;
    refuse(what + " is missing");
  }
  double number(const std::string& text, double least, double most, const std::string& what) const {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most)) {
      std::ostringstream range;
      range << what << " is '" << text << "'; it must be a number from " << least << " to " << most;
      refuse(range.str());
    }
    return value;
  }
  double need_number(double least, double most, const std::string& what) { return number(need(what), least, most, what); }
  ui::Vec2 place(const std::string& text) const {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) refuse("'" + text + "' is no place; write x,y in parts of the widget, as in 0.5,0.5");
    return {static_cast<float>(number(text.substr(0, comma), -5, 5, "x")),
            static_cast<float>(number(text.substr(comma + 1), -5, 5, "y"))};
  }
  void finish() {
    if (const auto more = word()) refuse("'" + *more + "' is one word too many");
  }

 private:
  std::istringstream words_;
  const std::string& file_;
  int number_;
};

constexpr std::array<std::pair<std::string_view, ui::Key>, 13> keys = {{{"left", ui::Key::left},
                                                                        {"right", ui::Key::right},
                                                                        {"up", ui::Key::up},
                                                                        {"down", ui::Key::down},
                                                                        {"home", ui::Key::home},
                                                                        {"end", ui::Key::end},
                                                                        {"page-up", ui::Key::page_up},
                                                                        {"page-down", ui::Key::page_down},
                                                                        {"escape", ui::Key::escape},
                                                                        {"enter", ui::Key::enter},
                                                                        {"backspace", ui::Key::backspace},
                                                                        {"f1", ui::Key::f1},
                                                                        {"f11", ui::Key::f11}}};

Drag read_drag(LineReader& line) {
  Drag drag;
  drag.widget = line.need("the widget's name");
  std::string last;
  while (const auto w = line.word()) {
    if (w->find(',') == std::string::npos) {
      drag.time = from_seconds(line.number(*w, 0.05, 60, "the time in seconds"));
      line.finish();
      break;
    }
    drag.way.push_back(line.place(*w));
  }
  if (drag.way.size() < 2) line.refuse("a drag needs at least two places, as in 0.2,0.5 0.8,0.5");
  if (drag.time == Duration::zero()) drag.time = std::chrono::milliseconds(400);
  return drag;
}

Action read_action(const std::string& verb, LineReader& line) {
  if (verb == "wait") return Wait{from_seconds(line.need_number(0, 3600, "the time in seconds"))};
  if (verb == "press" || verb == "release") return Pedal{verb == "press"};
  if (verb == "await") {
    const std::string state = line.need("the state");
    if (state != "idle" && state != "live" && state != "recording" && state != "review") {
      line.refuse("'" + state + "' is no state; there are idle, live, recording and review");
    }
    return Await{state, from_seconds(line.need_number(0, 3600, "the longest wait in seconds"))};
  }
  if (verb == "tap" || verb == "double-tap") return Tap{line.need("the widget's name"), verb == "tap" ? 1 : 2};
  if (verb == "hold") {
    std::string widget = line.need("the widget's name");
    return Hold{std::move(widget), from_seconds(line.need_number(0.05, 60, "the time in seconds"))};
  }
  if (verb == "drag") return read_drag(line);
  if (verb == "pinch") {
    std::string widget = line.need("the widget's name");
    return Pinch{std::move(widget), static_cast<float>(line.need_number(0.2, 5, "the scale")), 0};
  }
  if (verb == "twist") {
    std::string widget = line.need("the widget's name");
    const double deg = line.need_number(-720, 720, "the angle in degrees");
    return Pinch{std::move(widget), 1, static_cast<float>(deg * std::numbers::pi / 180)};
  }
  if (verb == "key") {
    const std::string name = line.need("the key");
    KeyPress press;
    for (const auto& [word, key] : keys) {
      if (word == name) press.key.key = key;
    }
    if (press.key.key == ui::Key::character) {
      if (name.size() != 1) line.refuse("'" + name + "' is no key");
      press.key.character = static_cast<char32_t>(name[0]);
    }
    return press;
  }
  if (verb == "shot") {
    std::string file = line.need("the file's name");
    if (file.find('/') != std::string::npos || !file.ends_with(".png")) {
      line.refuse("'" + file + "' is no name of a picture; write one without folders that ends in .png");
    }
    return Shot{std::move(file)};
  }
  line.refuse("'" + verb + "' is no action; app/screen/screen_script.h lists them");
}

}  // namespace

std::vector<Step> parse(std::string_view text, const std::string& file) {
  std::vector<Step> steps;
  std::istringstream in{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    LineReader reader(line, file, number);
    const auto verb = reader.word();
    if (!verb) continue;
    Action action = read_action(*verb, reader);
    reader.finish();
    steps.push_back({number, std::move(action)});
  }
  return steps;
}

}  // namespace sonoband::screen_script
