// Drawing in pixels on the frame being made: shapes, type, icons and pictures. Nothing here allocates once a
// frame of the same content has been drawn before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "ui/pictures.h"
#include "ui/rect.h"
#include "ui/theme.h"

namespace sonoband::ui {

// Bytes of font files: two weights of the type and one of symbols (Font Awesome 4's code points).
struct FontFiles {
  std::vector<std::uint8_t> regular;
  std::vector<std::uint8_t> strong;
  std::vector<std::uint8_t> icons;
};

enum class Icon : char16_t {
  none = 0,
  live = 0xf03d,
  review = 0xf009,
  exams = 0xf07c,
  set_up = 0xf013,
  move = 0xf047,
  curve = 0xf040,
  landmark = 0xf041,
  measure = 0xf07e,
  contour = 0xf1db,
  undo = 0xf0e2,
  redo = 0xf01e,
  clear = 0xf12d,
  play = 0xf04b,
  pause = 0xf04c,
  record = 0xf111,
  stop = 0xf04d,
  grow = 0xf065,
  shrink = 0xf066,
  snapshot = 0xf030,
  sun = 0xf185,
  adjust = 0xf042,
  warning = 0xf071,
  close = 0xf00d,
  check = 0xf00c,
  help = 0xf059,
  bin = 0xf1f8,
  plus = 0xf067,
  minus = 0xf068,
  export_to = 0xf08e,
  sound = 0xf028,
  silent = 0xf026,
  back = 0xf053,
  forward = 0xf054,
  backspace = 0xf060,
  home = 0xf015,
};

enum class Align : std::uint8_t { left, centre, right };

struct SceneTexture;  // ui/scene.h

class Draw {
 public:
  // `list` is the frame's Dear ImGui draw list, `fonts` its five fonts in the order of Type.
  struct Frame;
  explicit Draw(Frame& frame) : frame_(frame) {}

  void fill(const Rect& r, Colour c, float radius = 0);
  void outline(const Rect& r, Colour c, float thickness, float radius = 0);
  void line(Vec2 a, Vec2 b, Colour c, float thickness);
  void dashed(Vec2 a, Vec2 b, Colour c, float thickness, float dash);
  void polyline(std::span<const Vec2> points, Colour c, float thickness);
  void polygon(std::span<const Vec2> convex, Colour c);
  void disc(Vec2 centre, float radius, Colour c);
  void ring(Vec2 centre, float radius, Colour c, float thickness);

  float width_of(Type type, std::string_view text) const;
  float height_of(Type type) const;  // of a line
  void text(Vec2 top_left, Type type, Colour c, std::string_view text);
  // One line, in the middle of the height of `r`; what does not fit ends in an ellipsis.
  void text_in(const Rect& r, Align align, Type type, Colour c, std::string_view text);
  // Broken into lines at the width of `r` (never below it); returns the height taken.
  float paragraph(const Rect& r, Type type, Colour c, std::string_view text);
  void icon(Vec2 centre, float size_px, Colour c, Icon icon);

  // Everything until the matching end_clip stays inside `r`. They nest.
  void begin_clip(const Rect& r);
  void end_clip();

  // What `slot` holds fills `r`.
  void picture(Slot slot, const Rect& r, const Look& look);
  float picture_width(Slot slot) const;  // in its own pixels; 0: there is none
  float picture_height(Slot slot) const;
  void scene(const SceneTexture& picture, const Rect& r);

  // After everything else of the frame.
  void end();

 private:
  void note_kind(const TextureKind& texture);
  bool clear(const Rect& r, Colour c, float radius);

  Frame& frame_;
};

}  // namespace sonoband::ui
