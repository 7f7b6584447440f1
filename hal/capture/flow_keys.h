// From a raw capture of colour Doppler to the ordered keys of core/image/doppler.h, cropped and turned to MF:
// what luma.h is for grey. Colour is looked at only where the board's profile says that the scanner shows
// Doppler.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image/colour_bar.h"
#include "hal/capture/luma.h"

namespace sonoband {

class FlowKeys {
 public:
  explicit FlowKeys(const doppler::ColourClassifier& classifier);

  // Preconditions as of copy_luma. A hue that is not on the bar gives the darkest grey; a format without
  // colour, or whose colour is not taken from here (NV12), gives greys. YUYV and UYVY are taken for BT.601 of
  // limited range (what USB Video Class and HDMI bridges send unless they say otherwise); their grey is Y as
  // it is, as copy_luma's.
  void copy(const Frame& frame, const Crop& crop, ImageView<std::uint8_t> out) const;

 private:
  void copy_row(const Frame& frame, int from_x, const std::uint8_t* row, ImageView<std::uint8_t> out) const;
  std::uint8_t key_of_yuv(int y, int u, int v) const;

  doppler::ColourClassifier classifier_;
  std::array<std::uint8_t, 256> grey_{};      // 8 bits to the 7 of a Doppler picture
  std::vector<std::int16_t> colour_of_cell_;  // 32 x 32 x 32 of y, u, v; negative: grey
};

}  // namespace sonoband
