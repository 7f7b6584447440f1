// What is on the screen, by name: scripts press it, and a finger that lands finds what it hit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ui/rect.h"

namespace sonoband::ui {

// A widget's identity: a hash of its name, never 0.
constexpr std::uint64_t id_of(std::string_view name) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash == 0 ? 1 : hash;
}

struct Widget {
  std::uint64_t id = 0;
  std::array<char, 48> name{};  // zero-terminated; longer names are cut
  Rect rect;
  bool enabled = true;  // one that is not still hides what lies under it
};

// Filled anew by each frame, in the order of drawing: later ones lie on top.
class Widgets {
 public:
  Widgets() { all_.reserve(256); }
  void clear() { all_.clear(); }
  std::uint64_t add(std::string_view name, const Rect& rect, bool enabled = true);

  // The topmost at `p`; 0 when nothing, or something disabled, is there.
  std::uint64_t hit(Vec2 p) const;
  std::optional<Widget> find(std::string_view name) const;
  const std::vector<Widget>& all() const { return all_; }

 private:
  std::vector<Widget> all_;
};

}  // namespace sonoband::ui
