#include "ui/line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sonoband::ui {
namespace {

// Not in the middle of a character of UTF-8.
std::size_t cut(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text.size();
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return most;
}

}  // namespace

Arg::Arg(std::string_view word) {
  size_ = cut(word, text_.size());
  std::copy_n(word.data(), size_, text_.data());
}

Arg number(double value, int decimals) {
  if (!std::isfinite(value)) return {"–"};
  Arg a;
  const double least = 0.5 * std::pow(10.0, -decimals);
  if (std::abs(value) < least) value = 0;  // never "-0.0"
  const int n =
      std::snprintf(a.text_.data(), a.text_.size(), "%.*f", decimals, std::clamp(value, -1e15, 1e15));
  a.size_ = static_cast<std::size_t>(std::max(0, n));
  return a;
}

Arg count(std::uint64_t value) {
  std::array<char, 24> digits{};
  const int n = std::snprintf(digits.data(), digits.size(), "%llu", static_cast<unsigned long long>(value));
  Arg a;
  for (int i = 0; i < n; ++i) {
    if (i > 0 && (n - i) % 3 == 0) {
      for (const char c : std::string_view("\u2009")) a.text_[a.size_++] = c;  // thin space
    }
    a.text_[a.size_++] = digits[i];
  }
  return a;
}

Arg clock_time(double s) {
  Arg a;
  const double tenths = std::floor(std::clamp(s, 0.0, 359999.0) * 10 + 1e-6);
  const int minutes = static_cast<int>(tenths / 600);
  const int n =
      std::snprintf(a.text_.data(), a.text_.size(), "%02d:%04.1f", minutes, tenths / 10 - minutes * 60.0);
  a.size_ = static_cast<std::size_t>(std::max(0, n));
  return a;
}

Line::Line(std::string_view pattern, std::initializer_list<Arg> args) {
  while (!pattern.empty()) {
    const std::size_t open = pattern.find('{');
    add(pattern.substr(0, open));
    if (open == std::string_view::npos || open + 2 >= pattern.size() || pattern[open + 2] != '}') break;
    const auto which = static_cast<std::size_t>(pattern[open + 1] - '0');
    if (which < args.size()) add((args.begin() + which)->view());
    pattern.remove_prefix(open + 3);
  }
}

void Line::add(std::string_view more) {
  const std::size_t n = cut(more, text_.size() - size_);
  std::copy_n(more.data(), n, text_.data() + size_);
  size_ += n;
}

}  // namespace sonoband::ui
