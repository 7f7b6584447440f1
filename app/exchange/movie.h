// Movies: VP9 in WebM, which browsers and players show without more.
//
// Pictures are lossy (quality below) and their colours have half the resolution of their brightness: for
// looking at, not for measuring. Measure on sequences, DICOM or PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/exchange/png.h"

namespace sonoband::exchange {

struct MovieSettings {
  int width = 0;
  int height = 0;
  double x_mm = 0;  // of a pixel, so that the proportions are right; 0: not known, taken as square
  double y_mm = 0;
  double duration_s = 0;  // from the first picture to the end of the last
  int threads = 1;
  // VP9's quantiser, 0 to 63; 20 keeps speckle within 2 or 3 grey levels (tests/tools/movie_test.cpp).
  int quantiser = 20;
  // Names (TITLE and COMMENT are shown by players) and UTF-8 texts. The writer adds the pixel's size and that
  // this is for research use only.
  std::vector<std::pair<std::string, std::string>> tags;
};

// A file beside until `finish`, then renamed; destroyed before, nothing stays.
class MovieWriter {
 public:
  // Throws BadInput where the folder refuses, or the size is none that VP9 has (1 to 16384 a side).
  MovieWriter(const std::filesystem::path& path, const MovieSettings& settings);
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  // A picture of the movie's size, shown from `time_s` (from 0, kept to the millisecond) to the next one's.
  // Of pictures less than a millisecond apart the later ones come a millisecond late. Throws BadInput where
  // the encoder refuses.
  void add(const PngPicture& picture, double time_s);
  void finish();  // throws BadInput where the disk refused

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoband::exchange
