// What Draw stands on; only ui's own .cpp files that include Dear ImGui include this.
#pragma once

#include <imgui.h>

#include <array>

#include "ui/draw.h"

namespace sonoband::ui {

// A picture waits here until the renderer reaches its place in the draw list.
struct PictureOrder {
  Pictures* pictures = nullptr;
  Slot slot = Slot::live;
  Rect target;
  Look look;
  float screen_width = 0;
  float screen_height = 0;
};

// Likewise, a rectangle of one colour.
struct ClearOrder {
  Colour colour;
  float screen_height = 0;
};

// Waits there for its draw call.
struct Noted {
  DrawKinds* kinds = nullptr;
  TextureKind texture;
};

struct Draw::Frame {
  ImDrawList* list = nullptr;
  std::array<ImFont*, 5> fonts{};  // in the order of Type
  ImFont* icons = nullptr;
  Pictures* pictures = nullptr;
  std::array<PictureOrder, 64> orders{};  // more pictures than that on one screen are not drawn
  int order_count = 0;
  std::array<ClearOrder, 32> clears{};  // more are drawn as any other shape
  int clear_count = 0;
  DrawKinds* kinds = nullptr;
  TextureKind type_kind;         // of the texture that holds the fonts
  std::array<Noted, 8> noted{};  // one for each Outline, and one
  int noted_count = 0;
  float screen_width = 0;
  float screen_height = 0;
};

}  // namespace sonoband::ui
