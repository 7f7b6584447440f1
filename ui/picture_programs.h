// How the values of a picture become light, for every program that draws one: a program for each kind of
// picture, so that a grey pixel does none of the work of a coloured one (half of what Mesa's rasteriser took
// for a frame).
#pragma once

#include <array>

#include "core/image/image.h"

namespace sonoband::ui {

// How values become light.
struct Look {
  float gain = 0;       // added to the value, in parts of full white: -0.5 to 0.5
  float contrast = 1;   // about mid grey: 0.5 to 2.5
  bool colour = true;   // false: Doppler keys are drawn as greys of their level
  int least_level = 0;  // colours below this level (of 63) are drawn dark: wall motion, noise
  bool smooth = true;   // bilinear between pixels; never between Doppler keys
  bool operator==(const Look&) const = default;
};

class PicturePrograms {
 public:
  // `fragment` is a body that gets the light of a pixel from `vec4 light(vec2 at)`: red, green, blue, and
  // whether there is data (1 or 0); `at` is a place in the texture of unit 0. Unit 1 has the 256 colours of
  // the Doppler keys. Needs a current context, as all below do.
  PicturePrograms(const char* vertex, const char* fragment);
  ~PicturePrograms();
  PicturePrograms(const PicturePrograms&) = delete;
  PicturePrograms& operator=(const PicturePrograms&) = delete;

  // Makes the program for such a picture the current one, with this look, and returns GL's number of it. With
  // `covered` the texture's second channel tells where there is data.
  unsigned use(PixelKind kind, bool covered, const Look& look) const;

 private:
  struct Program {
    unsigned number = 0;
    int at_window = -1, at_colour = -1, at_least_level = -1;
  };
  std::array<Program, 4> programs_{};  // grey, Doppler; without coverage, with it
};

}  // namespace sonoband::ui
