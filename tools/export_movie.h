// `export --format webm`: its choices, and a sweep's band on a turn-table.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/exchange/exam_export.h"
#include "tools/plane_options.h"
#include "tools/render_options.h"

namespace sonoband::tools {

struct MovieOptions {
  bool turn_table = false;
  std::string axis = "down";
  int pictures = 120;
  double pictures_per_second = 15;
  std::shared_ptr<PlaneOptions> plane;
  std::shared_ptr<RenderOptions> render;
};

std::shared_ptr<MovieOptions> add_movie_options(CLI::App& verb);

// Wrong usage that can be seen before anything is read.
void check_movie_options(const MovieOptions& options);

// The turn-table of each sweep that `what` names. Throws BadInput, CLI::ValidationError, exam::StoreError.
exchange::ExportedExam write_turns(const MovieOptions& options, const std::filesystem::path& file,
                                   const exchange::ExamExport& what);

}  // namespace sonoband::tools
