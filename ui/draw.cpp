#include "ui/draw.h"

#include <GLES3/gl3.h>

#include "ui/draw_frame.h"
#include "ui/scene.h"

namespace sonoband::ui {
namespace {

ImVec2 im(Vec2 v) {
  return {v.x, v.y};
}
ImU32 im(Colour c) {
  return IM_COL32(c.rgba >> 24, c.rgba >> 16 & 255, c.rgba >> 8 & 255, c.rgba & 255);
}
ImFont* font_of(const Draw::Frame& frame, Type type) {
  return frame.fonts[static_cast<std::size_t>(type)];
}

// False: nothing of it is left.
bool clip_to(const ImVec4& clip, float screen_height) {
  if (clip.z <= clip.x || clip.w <= clip.y) return false;
  glScissor(static_cast<GLint>(clip.x), static_cast<GLint>(screen_height - clip.w),
            static_cast<GLsizei>(clip.z - clip.x), static_cast<GLsizei>(clip.w - clip.y));
  return true;
}

void paint_picture(const ImDrawList*, const ImDrawCmd* command) {
  const auto& order = *static_cast<const PictureOrder*>(command->UserCallbackData);
  if (!clip_to(command->ClipRect, order.screen_height)) return;
  // Pictures hide what is behind them.
  glDisable(GL_BLEND);
  order.pictures->paint(order.slot, order.target, order.look, order.screen_width, order.screen_height);
}

// Dear ImGui draws every shape with a texture and blending: for large ones of a solid colour that was half of
// what Mesa's rasteriser took for a frame. Smaller ones, in square pixels, are not worth a draw call.
constexpr float least_cleared = 12000;

void clear_rectangle(const ImDrawList*, const ImDrawCmd* command) {
  const auto& order = *static_cast<const ClearOrder*>(command->UserCallbackData);
  if (!clip_to(command->ClipRect, order.screen_height)) return;
  const std::uint32_t c = order.colour.rgba;
  glClearColor(static_cast<float>(c >> 24) / 255, static_cast<float>(c >> 16 & 255) / 255,
               static_cast<float>(c >> 8 & 255) / 255, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

}  // namespace

// The whole pixels within `r` and between its round corners are cleared, what is left is drawn.
bool Draw::clear(const Rect& r, Colour c, float radius) {
  if ((c.rgba & 255) != 255 || r.width * r.height < least_cleared) return false;
  const float round = radius > 0 ? radius + 1 : 0;
  const Vec2 from{std::ceil(r.x), std::ceil(r.y + round)};
  const Vec2 to{std::floor(r.right()), std::floor(r.bottom() - round)};
  if (to.x <= from.x || to.y <= from.y || frame_.clear_count == static_cast<int>(frame_.clears.size()))
    return false;
  const auto strip = [&](Vec2 a, Vec2 b, ImDrawFlags corners) {
    if (a.x < b.x && a.y < b.y) frame_.list->AddRectFilled(im(a), im(b), im(c), radius, corners);
  };
  strip({r.x, r.y}, {r.right(), from.y}, ImDrawFlags_RoundCornersTop);
  strip({r.x, to.y}, {r.right(), r.bottom()}, ImDrawFlags_RoundCornersBottom);
  strip({r.x, from.y}, {from.x, to.y}, ImDrawFlags_RoundCornersNone);
  strip({to.x, from.y}, {r.right(), to.y}, ImDrawFlags_RoundCornersNone);
  ClearOrder& order = frame_.clears[frame_.clear_count++];
  order = {c, frame_.screen_height};
  begin_clip({from.x, from.y, to.x - from.x, to.y - from.y});
  frame_.list->AddCallback(clear_rectangle, &order);
  end_clip();
  return true;
}

void Draw::fill(const Rect& r, Colour c, float radius) {
  if (clear(r, c, radius)) return;
  frame_.list->AddRectFilled({r.x, r.y}, {r.right(), r.bottom()}, im(c), radius);
}

void Draw::outline(const Rect& r, Colour c, float thickness, float radius) {
  const float half = thickness / 2;  // the stroke stays inside
  frame_.list->AddRect({r.x + half, r.y + half}, {r.right() - half, r.bottom() - half}, im(c), radius, 0,
                       thickness);
}

void Draw::line(Vec2 a, Vec2 b, Colour c, float thickness) {
  frame_.list->AddLine(im(a), im(b), im(c), thickness);
}

void Draw::dashed(Vec2 a, Vec2 b, Colour c, float thickness, float dash) {
  const float all = length(b - a);
  if (all <= 0 || dash <= 0) return;
  const Vec2 u = (1 / all) * (b - a);
  for (float t = 0; t < all; t += 2 * dash) line(a + t * u, a + std::min(t + dash, all) * u, c, thickness);
}

void Draw::polyline(std::span<const Vec2> points, Colour c, float thickness) {
  if (points.size() < 2) return;
  for (const Vec2 p : points) frame_.list->PathLineTo(im(p));
  frame_.list->PathStroke(im(c), 0, thickness);
}

void Draw::polygon(std::span<const Vec2> convex, Colour c) {
  if (convex.size() < 3) return;
  for (const Vec2 p : convex) frame_.list->PathLineTo(im(p));
  frame_.list->PathFillConvex(im(c));
}

void Draw::disc(Vec2 centre, float radius, Colour c) {
  frame_.list->AddCircleFilled(im(centre), radius, im(c));
}

void Draw::ring(Vec2 centre, float radius, Colour c, float thickness) {
  frame_.list->AddCircle(im(centre), radius, im(c), 0, thickness);
}

float Draw::height_of(Type type) const {
  return font_of(frame_, type)->FontSize;
}

float Draw::width_of(Type type, std::string_view text) const {
  if (text.empty()) return 0;
  const ImFont* font = font_of(frame_, type);
  return font->CalcTextSizeA(font->FontSize, FLT_MAX, 0, text.data(), text.data() + text.size()).x;
}

void Draw::text(Vec2 top_left, Type type, Colour c, std::string_view text) {
  // Dear ImGui takes the length of a null pointer for its own to measure.
  if (text.empty()) return;
  const ImFont* font = font_of(frame_, type);
  // Whole pixels keep glyphs as sharp as they were rasterised.
  frame_.list->AddText(font, font->FontSize, {std::round(top_left.x), std::round(top_left.y)}, im(c),
                       text.data(), text.data() + text.size());
}

void Draw::text_in(const Rect& r, Align align, Type type, Colour c, std::string_view words) {
  if (words.empty() || r.empty()) return;
  constexpr std::string_view ellipsis = "…";
  const ImFont* font = font_of(frame_, type);
  float width = width_of(type, words);
  const bool cut = width > r.width + 0.5f;
  if (cut) {
    const char* rest = nullptr;
    const float room = std::max(0.0f, r.width - width_of(type, ellipsis));
    width = font->CalcTextSizeA(font->FontSize, room, 0, words.data(), words.data() + words.size(), &rest).x;
    words = {words.data(), static_cast<std::size_t>(rest - words.data())};
  }
  const float full = cut ? width + width_of(type, ellipsis) : width;
  float x = r.x;
  if (align == Align::centre) x += (r.width - full) / 2;
  if (align == Align::right) x += r.width - full;
  const float y = r.y + (r.height - font->FontSize) / 2;
  text({x, y}, type, c, words);
  if (cut) text({x + width, y}, type, c, ellipsis);
}

float Draw::paragraph(const Rect& r, Type type, Colour c, std::string_view words) {
  if (words.empty()) return 0;
  const ImFont* font = font_of(frame_, type);
  const char* end = words.data() + words.size();
  frame_.list->AddText(font, font->FontSize, {std::round(r.x), std::round(r.y)}, im(c), words.data(), end,
                       r.width);
  return font->CalcTextSizeA(font->FontSize, FLT_MAX, r.width, words.data(), end).y;
}

void Draw::icon(Vec2 centre, float size_px, Colour c, Icon icon) {
  if (icon == Icon::none) return;
  const auto code = static_cast<unsigned>(icon);
  const ImFontGlyph* glyph = frame_.icons->FindGlyph(static_cast<ImWchar>(code));
  if (glyph == nullptr) return;
  const float scale = size_px / frame_.icons->FontSize;
  const Vec2 middle{scale * (glyph->X0 + glyph->X1) / 2, scale * (glyph->Y0 + glyph->Y1) / 2};
  frame_.icons->RenderChar(frame_.list, size_px,
                           {std::round(centre.x - middle.x), std::round(centre.y - middle.y)}, im(c),
                           static_cast<ImWchar>(code));
}

void Draw::begin_clip(const Rect& r) {
  frame_.list->PushClipRect({r.x, r.y}, {r.right(), r.bottom()}, true);
}

void Draw::end_clip() {
  frame_.list->PopClipRect();
}

void Draw::picture(Slot slot, const Rect& r, const Look& look) {
  if (!frame_.pictures->has(slot) || r.empty()) return;
  if (frame_.order_count == static_cast<int>(frame_.orders.size())) return;
  PictureOrder& order = frame_.orders[frame_.order_count++];
  order = {frame_.pictures, slot, r, look, frame_.screen_width, frame_.screen_height};
  begin_clip(r);
  frame_.list->AddCallback(paint_picture, &order);
  frame_.list->AddCallback(ImDrawCallback_ResetRenderState, nullptr);
  end_clip();
}

float Draw::picture_width(Slot slot) const {
  return frame_.pictures->has(slot) ? static_cast<float>(frame_.pictures->width(slot)) : 0;
}

float Draw::picture_height(Slot slot) const {
  return frame_.pictures->has(slot) ? static_cast<float>(frame_.pictures->height(slot)) : 0;
}

void Draw::scene(const SceneTexture& picture, const Rect& r) {
  const auto number = static_cast<std::intptr_t>(picture.texture);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): Dear ImGui's name of a texture is a pointer
  const auto name = reinterpret_cast<ImTextureID>(number);
  frame_.list->AddImage(name, {r.x, r.y}, {r.right(), r.bottom()}, {0, picture.part.y}, {picture.part.x, 0});
  note_kind(picture.kind);
}

// Of what Dear ImGui's renderer has just drawn.
void Draw::note_kind(const TextureKind& texture) {
  if (frame_.noted_count == static_cast<int>(frame_.noted.size())) return;
  Noted& noted = frame_.noted[frame_.noted_count++];
  noted = {frame_.kinds, texture};
  frame_.list->AddCallback(
      [](const ImDrawList*, const ImDrawCmd* command) {
        const auto& it = *static_cast<const Noted*>(command->UserCallbackData);
        it.kinds->note(it.texture);
      },
      &noted);
}

void Draw::end() {
  note_kind(frame_.type_kind);
}

}  // namespace sonoband::ui
