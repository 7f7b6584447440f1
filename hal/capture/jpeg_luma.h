// The luma of motion-JPEG pictures. Warned about where it is chosen: blocks and subsampled chroma spoil
// edges.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/image/image.h"

namespace sonoband {

class JpegLuma {
 public:
  JpegLuma();
  ~JpegLuma();
  JpegLuma(const JpegLuma&) = delete;
  JpegLuma& operator=(const JpegLuma&) = delete;

  // False, with `out` in any state, if the bytes are no whole JPEG of exactly the size of `out`.
  bool decode(std::span<const std::uint8_t> jpeg, ImageView<std::uint8_t> out);
  // The same in colour: `out` has rows of `width` packed pixels of red, green and blue.
  bool decode_rgb(std::span<const std::uint8_t> jpeg, int width, int height, std::uint8_t* out);

 private:
  bool is_of_size(std::span<const std::uint8_t> jpeg, int width, int height);

  void* handle_;
};

}  // namespace sonoband
