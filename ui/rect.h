// Places on the screen, in pixels from the top left corner.
#pragma once

#include <algorithm>
#include <cmath>

namespace sonoband::ui {

struct Vec2 {
  float x = 0;
  float y = 0;
  bool operator==(const Vec2&) const = default;
};
constexpr Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator*(float s, Vec2 a) {
  return {s * a.x, s * a.y};
}
constexpr float dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}
inline float length(Vec2 a) {
  return std::hypot(a.x, a.y);
}

struct Rect {
  float x = 0;
  float y = 0;
  float width = 0;
  float height = 0;
  bool operator==(const Rect&) const = default;

  float right() const { return x + width; }
  float bottom() const { return y + height; }
  Vec2 centre() const { return {x + width / 2, y + height / 2}; }
  bool empty() const { return width <= 0 || height <= 0; }
  bool contains(Vec2 p) const { return p.x >= x && p.y >= y && p.x < right() && p.y < bottom(); }
  Rect inset(float by) const { return inset(by, by); }
  Rect inset(float by_x, float by_y) const {
    return {x + by_x, y + by_y, std::max(0.0f, width - 2 * by_x), std::max(0.0f, height - 2 * by_y)};
  }

  // Cut a strip off one side; what is left stays in *this. At most all of it.
  Rect cut_left(float by) {
    by = std::clamp(by, 0.0f, width);
    const Rect cut{x, y, by, height};
    x += by;
    width -= by;
    return cut;
  }
  Rect cut_right(float by) {
    by = std::clamp(by, 0.0f, width);
    width -= by;
    return {x + width, y, by, height};
  }
  Rect cut_top(float by) {
    by = std::clamp(by, 0.0f, height);
    const Rect cut{x, y, width, by};
    y += by;
    height -= by;
    return cut;
  }
  Rect cut_bottom(float by) {
    by = std::clamp(by, 0.0f, height);
    height -= by;
    return {x, y + height, width, by};
  }
};

// The i-th of `count` equal columns of `all`, `gap` apart.
inline Rect column(const Rect& all, int i, int count, float gap) {
  const float width = (all.width - gap * static_cast<float>(count - 1)) / static_cast<float>(count);
  return {all.x + static_cast<float>(i) * (width + gap), all.y, width, all.height};
}
inline Rect row(const Rect& all, int i, int count, float gap) {
  const float height = (all.height - gap * static_cast<float>(count - 1)) / static_cast<float>(count);
  return {all.x, all.y + static_cast<float>(i) * (height + gap), all.width, height};
}

// The largest rectangle of the shape width : height inside `all`, centred.
inline Rect fit(const Rect& all, float width, float height) {
  if (width <= 0 || height <= 0 || all.empty()) return {all.centre().x, all.centre().y, 0, 0};
  const float scale = std::min(all.width / width, all.height / height);
  const Vec2 c = all.centre();
  return {c.x - width * scale / 2, c.y - height * scale / 2, width * scale, height * scale};
}

}  // namespace sonoband::ui
