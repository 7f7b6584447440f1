// Which kinds of draw call the driver has met. A driver makes its code for a program together with the state
// it is drawn in, and does so at the first such call: with Mesa's rasteriser 28 to 45 ms for each, which a
// frame must not pay. So every kind is drawn once before the first frame (warm_up.h), and any first met later
// is counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonoband::ui {

// What a draw call reads at texture unit 0. Mesa's rasteriser makes other code for a side that is a power of
// two as well: see off_power_of_two.
struct TextureKind {
  unsigned format = 0;  // GL's sized name; 0: no texture is read
  unsigned filter = 0;
  bool wide_power = false;  // the width is a power of two
  bool high_power = false;
  bool operator==(const TextureKind&) const = default;
};
TextureKind texture_kind(unsigned format, unsigned filter, int width, int height);

// The least side of a texture, from `side` on, that is no power of two (1 is taken as none).
int off_power_of_two(int side);

class DrawKinds {
 public:
  DrawKinds() { met_.reserve(64); }

  // Beside each draw call, while its program and state are set.
  void note(const TextureKind& texture = {});
  // From now on a kind that was not met counts.
  void warm() { warm_ = true; }
  std::size_t met() const { return met_.size(); }
  std::uint64_t met_late() const { return warm_ ? late_ : met_.size(); }

 private:
  struct Kind {
    TextureKind texture;
    int program = 0;
    int samples = 0;  // a pixel of the target
    bool blends = false, tests_depth = false, writes_depth = false;
    bool operator==(const Kind&) const = default;
  };
  std::vector<Kind> met_;
  std::uint64_t late_ = 0;
  bool warm_ = false;
};

}  // namespace sonoband::ui
