#include "app/script/screen_actions.h"

#include <array>
#include <numbers>
#include <utility>

namespace sonoband::script {
namespace {

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

constexpr std::array<std::pair<std::string_view, ui::Page>, 4> pages = {{{"live", ui::Page::live},
                                                                         {"review", ui::Page::review},
                                                                         {"exams", ui::Page::exams},
                                                                         {"set-up", ui::Page::set_up}}};

void need_words(const Place& place, const Words& words, std::size_t count, const std::string& example) {
  if (words.size() != count) place.refuse(words[0] + " is written as in: " + example);
}

ui::Vec2 part_of_widget(const Place& place, const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos)
    place.refuse("'" + text + "' is no place; write x,y in parts of the widget, as in 0.5,0.5");
  // A finger may leave the widget it landed on.
  return {static_cast<float>(number_in(place, "x", text.substr(0, comma), -5, 5)),
          static_cast<float>(number_in(place, "y", text.substr(comma + 1), -5, 5))};
}

Drag drag_action(const Place& place, const Words& words) {
  Drag drag;
  if (words.size() > 1) drag.widget = words[1];
  drag.time = std::chrono::milliseconds(400);
  for (std::size_t i = 2; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    if (last && words[i].find(',') == std::string::npos) {
      drag.time = from_seconds(number_in(place, "seconds", words[i], 0.05, 60));
    } else {
      drag.way.push_back(part_of_widget(place, words[i]));
    }
  }
  if (drag.way.size() < 2)
    place.refuse("drag needs a widget and at least two places: drag reslice/picture 0.2,0.5 0.8,0.5");
  return drag;
}

KeyPress key_action(const Place& place, const Words& words) {
  need_words(place, words, 2, "key right");
  KeyPress press;
  for (const auto& [word, key] : keys) {
    if (word == words[1]) press.key.key = key;
  }
  if (press.key.key == ui::Key::character) {
    if (words[1].size() != 1) place.refuse("there is no key '" + words[1] + "'");
    press.key.character = static_cast<char32_t>(words[1][0]);
  }
  return press;
}

AwaitPage page_action(const Place& place, const Words& words) {
  need_words(place, words, 3, "await-page exams 60");
  for (const auto& [word, page] : pages) {
    if (word == words[1])
      return AwaitPage{page, from_seconds(number_in(place, "seconds", words[2], 0, 3600))};
  }
  place.refuse("the pages are live, review, exams and set-up, not '" + words[1] + "'");
}

}  // namespace

std::string_view name_of(ui::Page page) {
  return pages[static_cast<std::size_t>(page)].first;
}

std::optional<ScreenAction> screen_action(const Place& place, const Words& words) {
  const std::string& verb = words[0];
  if (verb == "tap" || verb == "double-tap") {
    need_words(place, words, 2, verb + " tools/curve");
    return Tap{words[1], verb == "tap" ? 1 : 2};
  }
  if (verb == "hold") {
    need_words(place, words, 3, "hold review/picture 0.8");
    return Hold{words[1], from_seconds(number_in(place, "seconds", words[2], 0.05, 60))};
  }
  if (verb == "drag") return drag_action(place, words);
  if (verb == "pinch") {
    need_words(place, words, 3, "pinch reslice/picture 1.5");
    return TwoFingers{words[1], static_cast<float>(number_in(place, "the scale", words[2], 0.2, 5)), 0};
  }
  if (verb == "twist") {
    need_words(place, words, 3, "twist reslice/picture 30");
    const double deg = number_in(place, "degrees", words[2], -720, 720);
    return TwoFingers{words[1], 1, static_cast<float>(deg * std::numbers::pi / 180)};
  }
  if (verb == "key") return key_action(place, words);
  if (verb == "where") {
    need_words(place, words, 2, "where rail/exams");
    return Where{words[1]};
  }
  if (verb == "await-page") return page_action(place, words);
  if (verb == "shot") {
    Shot shot{picture_file(place, words)};
    need_words(place, words, 2, "shot review.png");
    return shot;
  }
  return std::nullopt;
}

}  // namespace sonoband::script
