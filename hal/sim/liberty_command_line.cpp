#include "hal/sim/liberty_command_line.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace sonoband::sim {
namespace {

// 3, 3., 3.0 and 3.0E+00 are all three.
bool parse_number(std::span<const char> token, double& value) {
  std::array<char, 32> digits{};
  if (token.size() >= digits.size()) return false;
  std::copy(token.begin(), token.end(), digits.begin());
  char* end = nullptr;
  value = std::strtod(digits.data(), &end);
  return end == digits.data() + token.size() && value > -1e9 && value < 1e9;
}

std::span<const char> trimmed(std::span<const char> s) {
  while (!s.empty() && s.front() == ' ') s = s.subspan(1);
  while (!s.empty() && s.back() == ' ') s = s.first(s.size() - 1);
  return s;
}

}  // namespace

CommandLine parse_command_line(std::span<const char> line) {
  constexpr std::uint8_t invalid_command = 0x01;
  constexpr std::uint8_t invalid_parameter = 0x03;
  constexpr std::uint8_t too_many = 0x05;

  CommandLine out;
  line = trimmed(line);
  if (line.empty()) {
    out.error = invalid_command;
    return out;
  }
  out.command = static_cast<std::uint8_t>(std::toupper(static_cast<unsigned char>(line.front())));
  line = line.subspan(1);
  if (out.command == '@') {
    if (line.empty() || std::toupper(static_cast<unsigned char>(line.front())) != 'B') {
      out.error = invalid_command;
      return out;
    }
    line = line.subspan(1);
  }
  if (trimmed(line).empty()) return out;
  for (bool more = true; more;) {
    const auto comma = std::find(line.begin(), line.end(), ',');
    const auto token = trimmed(line.first(static_cast<std::size_t>(comma - line.begin())));
    more = comma != line.end();
    line = more ? line.subspan(static_cast<std::size_t>(comma - line.begin()) + 1) : line.last(0);
    if (out.count == CommandLine::max_arguments) {
      out.error = too_many;
      return out;
    }
    double value = 0;
    if (out.count == 0 && token.size() == 1 && token.front() == '*')
      out.every_station = true;
    else if (!token.empty() && !parse_number(token, value))
      out.error = invalid_parameter;
    else if (!token.empty())
      out.arguments[static_cast<std::size_t>(out.count)] = value;
    ++out.count;
  }
  return out;
}

}  // namespace sonoband::sim
