// A line of text put together without the heap.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace sonoband::ui {

// A number made ready to show, or a word; fits in 31 bytes.
class Arg {
 public:
  Arg(std::string_view word);
  Arg(const char* word) : Arg(std::string_view(word)) {}
  std::string_view view() const { return {text_.data(), size_}; }

 private:
  friend Arg number(double value, int decimals);
  friend Arg count(std::uint64_t value);
  friend Arg clock_time(double s);
  Arg() = default;
  std::array<char, 64> text_{};
  std::size_t size_ = 0;
};

Arg number(double value, int decimals);  // not finite: an en dash
Arg count(std::uint64_t value);          // thousands apart: 3 412
Arg clock_time(double s);                // 00:06.4

// `pattern` with {0}, {1} ... replaced; a translation may turn them round. Longer than 255 bytes is cut
// between characters.
class Line {
 public:
  Line() = default;
  Line(std::string_view pattern, std::initializer_list<Arg> args);
  operator std::string_view() const { return {text_.data(), size_}; }
  std::string_view view() const { return *this; }
  void add(std::string_view more);

 private:
  std::array<char, 256> text_{};
  std::size_t size_ = 0;
};

}  // namespace sonoband::ui
