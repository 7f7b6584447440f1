#include "app/cart/picture.h"

#include <cassert>
#include <cstdlib>

namespace sonoband::cart {
std::optional<LossCause> unusable(const Frame& frame, int width, int height) {
  switch (check_frame(frame, width, height)) {
    case FrameFault::none:
      return std::nullopt;
    case FrameFault::format:
      return LossCause::bad_format;
    case FrameFault::size:
      return LossCause::bad_size;
  }
  return LossCause::bad_format;
}

bool differ_less(ConstPixels a, ConstPixels b, std::uint64_t limit) {
  assert(a.width == b.width && a.height == b.height);
  std::uint64_t sum = 0;
  for (int y = 0; y < a.height && sum < limit; ++y) {
    const std::uint8_t* pa = a.row(y);
    const std::uint8_t* pb = b.row(y);
    std::uint32_t row = 0;
    for (int x = 0; x < a.width; ++x) row += static_cast<std::uint32_t>(std::abs(pa[x] - pb[x]));
    sum += row;
  }
  return sum < limit;
}

}  // namespace sonoband::cart
