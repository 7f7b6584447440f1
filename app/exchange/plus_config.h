// The parts of a PLUS configuration (XML) that say where pixels lie and which of them are ultrasound.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/exchange/sequence.h"
#include "core/image/image.h"

namespace sonoband::exchange {

// <Transform From To Matrix Error Date>
struct ConfigTransform {
  TransformName name;
  Eigen::Matrix4d to_from_from;
  std::string place;  // file and line, for sentences
  std::string error;  // as written, usually mm; empty: not said
  std::string date;
};

// In MF pixels.
struct ClipRectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

// A sector whose apex is `origin_px`. Angles are from the picture's +y (down) towards +x; radii in pixels.
// Source: PLUS, volume reconstruction, clipping.
struct Fan {
  std::array<double, 2> origin_px{};
  double from_deg = 0;
  double to_deg = 0;
  double start_px = 0;
  double stop_px = 500;  // PLUS's own default
};

struct PlusConfig {
  std::vector<ConfigTransform> transforms;
  std::optional<ClipRectangle> clip;
  std::optional<Fan> fan;
  std::vector<std::string> warnings;
};

// Every Transform of <CoordinateDefinitions>, wherever that stands, and every other Transform that has From,
// To and Matrix (calibration results have no CoordinateDefinitions). Clip and fan are those of the first
// <VolumeReconstruction> that has them; the clip of a video device is applied before a file is written and
// that of <Segmentation> is for its own algorithm. Throws BadInput with file and line.
PlusConfig parse_plus_config(std::string_view xml, const std::string& file);
PlusConfig read_plus_config(const std::filesystem::path& path);

// Several files as one, read in this order: of two transforms between the same frames the later counts, and
// so does the later clip or fan.
PlusConfig read_plus_configs(const std::vector<std::filesystem::path>& paths);

// Non-zero where a pixel lies in all that is given; empty when nothing is given. Throws BadInput naming
// `place` when nothing would be left.
Pixels sector_mask(int width, int height, const std::optional<ClipRectangle>& clip,
                   const std::optional<ClipRectangle>& second_clip, const std::optional<Fan>& fan,
                   const std::string& place);

}  // namespace sonoband::exchange
