// Small text pieces that every header reader and writer needs. Locale never matters here.
#pragma once

#include <array>
#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonoband::exchange {

std::string_view trim(std::string_view text);
bool same_name(std::string_view a, std::string_view b);  // ASCII letters compare without case
bool starts_with_name(std::string_view text, std::string_view prefix);

// Tokens between runs of blanks and tabs.
std::vector<std::string_view> split_blanks(std::string_view text);

// The whole of `text` is one number. Takes a leading +, three-digit exponents, nan and inf, and the Windows
// spellings 1.#QNAN and 1.#INF.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

// All of `text` is exactly `count` numbers between blanks; empty otherwise.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);

// The shortest digits that read back as the same double (at most 17).
std::string format_number(double value);

enum class LineStatus : std::uint8_t { ok, end, too_long };

// One line without its LF or CRLF, at most `longest` bytes. `end` only when nothing is left to read.
LineStatus read_line(std::istream& in, std::string& line, std::size_t longest = std::size_t{1} << 20);

}  // namespace sonoband::exchange
