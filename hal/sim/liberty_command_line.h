// A command as the unit reads it: the letters, and its arguments with their gaps.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace sonoband::sim {

struct CommandLine {
  static constexpr int max_arguments = 24;

  std::uint8_t command = 0;    // upper case; a control byte as it is; '@' for @B
  bool every_station = false;  // the first argument was '*'
  std::array<std::optional<double>, max_arguments> arguments;  // an omitted one keeps its setting
  int count = 0;
  std::uint8_t error = 0;  // why it is no command: 01, 03 or 05

  std::optional<int> integer(int i) const {
    if (i >= count || !arguments[static_cast<std::size_t>(i)]) return std::nullopt;
    return static_cast<int>(*arguments[static_cast<std::size_t>(i)]);
  }
};

// `line` is without its CR.
CommandLine parse_command_line(std::span<const char> line);

}  // namespace sonoband::sim
