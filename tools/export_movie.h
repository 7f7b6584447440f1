// `export --format webm`: the cine of a sweep, or its band on a turn-table.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/exam/exam_reader.h"
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

// The file that was written into `folder`; adds to `damage` what it lacks. Throws BadInput,
// CLI::ValidationError.
std::filesystem::path write_movie(const MovieOptions& options, const exam::ExamReader& exam,
                                  const std::filesystem::path& file, std::int64_t sweep,
                                  const std::filesystem::path& folder, std::vector<std::string>& damage);

}  // namespace sonoband::tools
