// How a band is painted: options shared by the verbs that render.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/reslice/band.h"

namespace sonoband::tools {

struct RenderOptions {
  double thickness_mm = 0;
  Compounding compounding = Compounding::maximum;
  Interpolation interpolation = Interpolation::nearest;
  std::string gap = "auto";
  int threads = 0;  // 0: one for each processor
};

// --interpolation, --gap-mm, --threads.
std::shared_ptr<RenderOptions> add_render_options(CLI::App& verb);
// --thickness-mm and --compounding as well.
void add_band_options(CLI::App& verb, const std::shared_ptr<RenderOptions>& options);

// The band's step is the width of a B-scan's pixel. Throws CLI::ValidationError.
RenderSettings settings_of(const RenderOptions& options, double step_mm);
int threads_of(const RenderOptions& options);

nlohmann::ordered_json settings_json(const RenderSettings& settings);

}  // namespace sonoband::tools
