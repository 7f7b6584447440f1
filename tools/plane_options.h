// Where a picture is taken: options shared by the verbs that paint planes.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "core/geometry/plane.h"
#include "core/reslice/band.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband::tools {

// "X,Y,Z": exactly `count` finite numbers between commas. Throws CLI::ValidationError naming `option`.
std::vector<double> comma_numbers(const std::string& text, std::size_t count, const std::string& option);
Eigen::Vector3d comma_vector(const std::string& text, const std::string& option);

// Texts as they were given; they are understood when the plane is asked for.
struct PlaneOptions {
  std::string origin;
  std::string right;
  std::string down;
  std::string size;
  double pixel_mm = 0;  // 0: as wide as a B-scan's pixel
};

std::shared_ptr<PlaneOptions> add_plane_options(CLI::App& verb);

// The plane that was asked for, in mm of the world; without one default_plane's, `given` tells which. Throws
// CLI::ValidationError when the options make no plane, or only some of them are there.
struct ChosenPlane {
  ReslicePlane plane;
  bool given = false;
};
ChosenPlane choose_plane(const PlaneOptions& options, const SweepView& sweep);

// Wrong usage that can be seen before anything is read.
void check_plane_options(const PlaneOptions& options);

// Throws CLI::ValidationError where picture and band together would not fit the memory.
void check_picture_size(const ReslicePlane& plane, const Band& band);

}  // namespace sonoband::tools
