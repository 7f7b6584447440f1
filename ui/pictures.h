// Pictures on the graphics processor: one texture per place on the screen, sent again only when its version
// changes. Grey windowing and Doppler colours are done by the shader, so that moving a slider sends nothing.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image/colour_bar.h"
#include "core/image/image.h"
#include "ui/draw_kinds.h"
#include "ui/picture_programs.h"
#include "ui/rect.h"

namespace sonoband::ui {

// Borrowed for the frame. `version` changes whenever the pixels do; 0: there is no picture.
struct Picture {
  ConstPixels pixels;
  ImageView<const std::uint16_t> coverage;  // empty: there is data everywhere
  PixelKind kind = PixelKind::grey;
  std::uint64_t version = 0;
};

// Each holds one picture.
enum class Slot : std::uint8_t { live, growing, bscan, reslice, manifold, outline, thumbnails };
constexpr int thumbnail_count = 24;
constexpr int slot_count = static_cast<int>(Slot::thumbnails) + thumbnail_count;
constexpr Slot thumbnail(int i) {
  return static_cast<Slot>(static_cast<int>(Slot::thumbnails) + i);
}

class Pictures {
 public:
  // Needs a current context, as everything below and the destructor do.
  explicit Pictures(DrawKinds& kinds, const doppler::ColourBar& bar = doppler::red_blue_bar());
  ~Pictures();
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  // From now on the slot has this picture, which is sent with the next `send` if it differs from what the
  // slot holds; until then it is borrowed. Pictures larger than 4095 on a side are cut.
  void show(Slot slot, const Picture& picture);
  void send();

  bool has(Slot slot) const { return at(slot).version != 0; }
  int width(Slot slot) const { return at(slot).width; }
  int height(Slot slot) const { return at(slot).height; }
  unsigned texture(Slot slot) const { return at(slot).texture; }
  // The picture is this part of its texture, from the first texel on; the rest repeats its edge.
  Vec2 part(Slot slot) const { return at(slot).part(); }
  // As it is drawn, smooth or not.
  TextureKind texture_kind(Slot slot, bool smooth) const;
  PixelKind kind(Slot slot) const { return at(slot).kind; }
  bool has_coverage(Slot slot) const { return at(slot).has_coverage; }
  unsigned palette() const { return palette_; }
  std::uint64_t uploads() const { return uploads_; }  // since the start

  // Fills `target` (pixels of a framebuffer `screen_width` x `screen_height`) with the picture. Leaves
  // program, vertex array and texture units 0 and 1 changed.
  void paint(Slot slot, const Rect& target, const Look& look, float screen_width, float screen_height);

 private:
  struct Held {
    unsigned texture = 0;
    int width = 0;
    int height = 0;
    PixelKind kind = PixelKind::grey;
    bool has_coverage = false;
    std::uint64_t version = 0;
    bool has_room = false;  // the texture is of this size and kind
    Picture to_send;        // version 0: nothing

    int texture_width() const { return off_power_of_two(width); }
    int texture_height() const { return off_power_of_two(height); }
    Vec2 part() const {
      return {static_cast<float>(width) / static_cast<float>(texture_width()),
              static_cast<float>(height) / static_cast<float>(texture_height())};
    }
  };
  void send(Held& held);
  void stage(const Held& held);
  const Held& at(Slot slot) const { return held_[static_cast<std::size_t>(slot)]; }

  DrawKinds& kinds_;
  std::array<Held, slot_count> held_{};
  std::vector<std::uint8_t> staging_;  // what is not sent as it lies
  unsigned palette_ = 0;               // 256 colours of the Doppler keys
  PicturePrograms programs_;
  unsigned vertices_ = 0;
  std::uint64_t uploads_ = 0;
};

}  // namespace sonoband::ui
