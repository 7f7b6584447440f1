// What the verbs that paint one picture write: the picture, its coverage, and what was done.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/reslice/band.h"
#include "tools/plane_options.h"
#include "tools/sweep_options.h"

namespace sonoband::tools {

using Json = nlohmann::ordered_json;

struct PictureOutputs {
  std::filesystem::path picture;
  std::filesystem::path coverage;
  std::filesystem::path json;
};

// --out, --coverage, --json.
std::shared_ptr<PictureOutputs> add_picture_outputs(CLI::App& verb);

// Throws CLI::ValidationError where one of them, or of the `more` that a verb writes, is a file that is read
// or another of them.
void check_outputs(const SweepOptions& sweep, const PictureOutputs& out,
                   const std::vector<NamedFile>& more = {});

// choose_plane; a plane that was not given is printed, so that it can be given next time.
ReslicePlane plane_of(const PlaneOptions& options, const SweepView& sweep, const std::string& world);

// {sequence, plane, band, compounding, interpolation, gap_mm, pixels, frames, coverage, milliseconds,
// warnings}
Json picture_json(const SweepOptions& options, const exchange::SequenceSweep& sweep,
                  const ReslicePlane& plane, const RenderSettings& settings, const BandImage& image,
                  double milliseconds);

// Writes what `out` names, Doppler in the bar's colours; `json` as picture_json gives it, or with more in it.
// Throws BadInput.
void write_picture(const BandImage& image, const doppler::ColourBar& bar, const RenderSettings& settings,
                   const Json& json, const PictureOutputs& out);

// One line about the picture, one for each cause of frames left out, and a warning where nothing is in it.
void print_picture(const exchange::SequenceSweep& sweep, const RenderSettings& settings,
                   const BandImage& image, double milliseconds, const PictureOutputs& out);

void write_json(const Json& json, const std::filesystem::path& path);

}  // namespace sonoband::tools
