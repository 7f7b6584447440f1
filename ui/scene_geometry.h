// What the Outline window shows, as lines and faces: the B-scans' outlines, and what is set and drawn among
// them. No GL.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/plane.h"
#include "core/sweep/tracked_frame.h"
#include "ui/interact/outline_view.h"
#include "ui/pictures.h"
#include "ui/theme.h"

namespace sonoband::ui {

struct SceneInput {
  std::span<const TrackedFrame* const> frames;
  std::uint64_t frames_version = 0;
  int current = -1;                                     // drawn in the colour of the current B-scan
  std::optional<std::array<Eigen::Vector3d, 4>> probe;  // corners of the live B-scan
  std::optional<ReslicePlane> plane;
  double thickness_mm = 0;
  bool band_on_plane = false;  // Slot::reslice, rendered for band_plane
  ReslicePlane band_plane;
  std::uint64_t band_version = 0;
  std::span<const Eigen::Vector2d> curve_mm;  // on the plane
  double reach_mm = 0;
  Orbit orbit;
  Look look;
};

// As the shaders read them (scene_shaders.h): mm from the middle of the sweep, where floats keep a
// micrometre.
struct SceneLine {
  float a[3];
  float b[3];
  std::uint8_t rgba[4];
  float width_px;
};
struct SceneCorner {
  float at[3];
  std::uint8_t rgba[4];
};

// Keeps its memory from one picture to the next.
class SceneGeometry {
 public:
  // B-scans, by their indices in input.frames, as arches, the deep side open. Replaces what was there, as the
  // other does.
  void make_outlines(const SceneInput& input, std::span<const int> shown, const SweepFrame& sweep);
  // The current B-scan, the probe, the plane with the limits of its band, the curve's surface; `line_px` is
  // the width of a thin line.
  void make_marks(const SceneInput& input, const SweepFrame& sweep, float line_px);

  std::span<const SceneLine> lines() const { return lines_; }
  std::span<const SceneCorner> corners() const { return corners_; }  // three a triangle

 private:
  void add_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px);
  void add_dashed(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px,
                  double dash_mm);
  void add_arch(const std::array<Eigen::Vector3d, 4>& corners, Colour c, float width_px);
  void add_quad(const std::array<Eigen::Vector3d, 4>& corners, Colour c);
  void add_plane(const SceneInput& input, const ReslicePlane& p, float line_px);
  void add_surface(const SceneInput& input, const ReslicePlane& p, float line_px);

  SweepFrame sweep_;
  std::vector<SceneLine> lines_;
  std::vector<SceneCorner> corners_;
};

}  // namespace sonoband::ui
