// PNG pictures: grey or RGB, eight bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>
#include <utility>
#include <vector>

#include "core/image/colour_bar.h"
#include "core/image/image.h"
#include "core/reslice/band.h"

namespace sonoband::exchange {

struct PngPicture {
  int width = 0;
  int height = 0;
  int channels = 1;                 // 1 grey, 3 red green blue
  std::vector<std::uint8_t> bytes;  // rows packed
  double pixel_mm = 0;              // 0: not said; written as pixels per metre
  // Keyword and Latin-1 text, as tEXt chunks; keywords of 1 to 79 characters.
  std::vector<std::pair<std::string, std::string>> texts;
};

PngPicture grey_png(ConstPixels pixels);

// As people see it: grey as it is; Doppler keys in the colours of the bar.
PngPicture picture_png(ConstPixels pixels, PixelKind kind,
                       const doppler::ColourBar& bar = doppler::red_blue_bar());
PngPicture band_png(const BandImage& image, const doppler::ColourBar& bar = doppler::red_blue_bar());

// 0 where no layer had data, else round(255 count / layers), at least 1.
PngPicture coverage_png(const BandImage& image, int layers);

// Beside, then renamed. Throws BadInput where the disk refuses.
void write_png(const PngPicture& picture, const std::filesystem::path& path);

// Eight-bit grey or RGB, each side up to 65 535. Throws BadInput.
PngPicture read_png(const std::filesystem::path& path);
PngPicture read_png(std::istream& in, const std::string& name);

}  // namespace sonoband::exchange
