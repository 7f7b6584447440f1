// What the readers of a script's lines share.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "app/bad_input.h"

namespace sonoband::script {

// Where a sentence points to.
struct Place {
  const std::string& file;
  int line;

  [[noreturn]] void refuse(const std::string& sentence) const {
    throw BadInput(file + ":" + std::to_string(line) + ": " + sentence);
  }
};

using Words = std::vector<std::string>;

inline std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

inline double number_in(const Place& place, const std::string& name, std::string_view text, double least,
                        double most) {
  const auto value = number(text);
  if (!value || *value < least || *value > most) {
    std::ostringstream range;
    range << least << " to " << most;
    place.refuse(name + " must be a number from " + range.str() + ", not '" + std::string(text) + "'");
  }
  return *value;
}

inline std::string picture_file(const Place& place, const Words& words) {
  if (words.size() < 2 || !words[1].ends_with(".png"))
    place.refuse(words[0] + " needs the name of a .png file first");
  if (words[1].find('/') != std::string::npos)
    place.refuse("pictures go into a folder of their own: give a name without '/'");
  return words[1];
}

}  // namespace sonoband::script
