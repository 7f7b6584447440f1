#include "app/exchange/text.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace sonoband::exchange {

namespace {

constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

constexpr char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

bool starts_with_name(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() && same_name(text.substr(0, prefix.size()), prefix);
}

std::vector<std::string_view> split_blanks(std::string_view text) {
  std::vector<std::string_view> tokens;
  std::size_t at = 0;
  while (at < text.size()) {
    while (at < text.size() && is_blank(text[at])) ++at;
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    if (end > at) tokens.push_back(text.substr(at, end - at));
    at = end;
  }
  return tokens;
}

std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end == text.data()) return std::nullopt;
  const std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  // Microsoft's C library printed 1.#QNAN, -1.#IND and 1.#INF before 2015.
  if (starts_with_name(rest, "#INF") || starts_with_name(rest, "#QNAN") || starts_with_name(rest, "#SNAN") ||
      starts_with_name(rest, "#IND"))
    return std::numeric_limits<double>::quiet_NaN();
  if (!rest.empty()) return std::nullopt;
  // Out of range: too small is as good as 0, too large is no number a header may hold.
  if (error == std::errc::result_out_of_range) {
    return text.find_first_of("eE") != std::string_view::npos &&
                   text.find('-', text.find_first_of("eE")) != std::string_view::npos
               ? 0.0
               : std::numeric_limits<double>::infinity();
  }
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count) {
  const auto tokens = split_blanks(text);
  if (tokens.size() != count) return std::nullopt;
  std::vector<double> numbers;
  numbers.reserve(count);
  for (const std::string_view token : tokens) {
    const auto number = parse_number(token);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::string format_number(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

LineStatus read_line(std::istream& in, std::string& line, std::size_t longest) {
  line.clear();
  std::streambuf& bytes = *in.rdbuf();
  bool any = false;
  for (int c = bytes.sbumpc(); c != std::char_traits<char>::eof(); c = bytes.sbumpc()) {
    any = true;
    if (c == '\n') {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      return LineStatus::ok;
    }
    if (line.size() == longest) return LineStatus::too_long;
    line.push_back(static_cast<char>(c));
  }
  return any ? LineStatus::ok : LineStatus::end;
}

}  // namespace sonoband::exchange
