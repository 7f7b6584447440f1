// The curve a surface stands on, and how it flows: options shared by `flow` and `manifold`.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/manifold/flow.h"

namespace sonoband::tools {

struct CurveOptions {
  FlowMethod method = FlowMethod::exact;
  double smooth_px = 4;
};

// --smooth-px, and the method under the name `method_option`.
std::shared_ptr<CurveOptions> add_curve_options(CLI::App& verb, const std::string& method_option);

const char* name_of(FlowMethod method);

// "x,y x,y ...", blanks between points. Throws CLI::ValidationError naming `option`.
std::vector<PlanePoint> curve_text(const std::string& text, const std::string& option);

// One point x,y per line; empty lines, lines that begin with # and a line "x,y" before the points do not
// count. Throws BadInput naming the line.
std::vector<PlanePoint> read_curve_csv(const std::filesystem::path& path);

// make_curve; four or more points of which the last is the first are a closed curve. Fault none: good.
CurveResult curve_of(const std::vector<PlanePoint>& points, const CurveOptions& options, double pixel_mm);

}  // namespace sonoband::tools
