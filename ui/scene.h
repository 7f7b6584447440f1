// The Outline window's picture: every B-scan's outline in space (an arch, its deep side open), the reslice
// plane with its band as a picture on it and the band's limits, the surface of the curve, the probe. Drawn
// with lines of even width, depth-tested, into a texture that is made anew only when something in it changes.
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

class Scene {
 public:
  explicit Scene(Pictures& pictures);  // needs a current context
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // The view the picture is made for, in pixels of a window at (0,0) of this size.
  OutlineView view(const SceneInput& input, const Rect& window);

  // The texture of the scene `width` x `height`; rows from the bottom. `draw` fills it; until then what the
  // input borrows must stay.
  unsigned render(const SceneInput& input, int width, int height, float line_px);
  // Draws what was last asked for, if something in it has changed. Restores the framebuffer that was bound.
  void draw();

  std::uint64_t renders() const { return renders_; }  // since the start

 private:
  struct Line {  // as the shader reads it
    float a[3];
    float b[3];
    std::uint8_t rgba[4];
    float width_px;
  };
  struct Corner {
    float at[3];
    std::uint8_t rgba[4];
  };
  struct Key {
    std::uint64_t frames_version = 0, band_version = 0, marks_hash = 0;
    int current = 0, width = 0, height = 0;
    Orbit orbit;
    Look look;
    bool operator==(const Key&) const = default;
  };

  void make_target(int width, int height);
  void send_frames(const SceneInput& input);
  void add_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px);
  void add_dashed(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px,
                  double dash_mm);
  void add_quad(const std::array<Eigen::Vector3d, 4>& corners, Colour c);
  void add_marks(const SceneInput& input, float line_px);
  void draw_lines(unsigned buffer, int count, float fade) const;

  Pictures& pictures_;
  SweepFrame sweep_;
  std::uint64_t sweep_version_ = 0;
  Key drawn_;
  bool drawn_once_ = false;
  SceneInput asked_;  // until it is drawn
  float asked_line_px_ = 1;
  bool waits_ = false;
  std::vector<Line> lines_;
  std::vector<Corner> corners_;
  unsigned line_program_ = 0, face_program_ = 0, band_program_ = 0;
  unsigned line_vertices_ = 0, face_vertices_ = 0, no_vertices_ = 0;
  unsigned frame_buffer_ = 0, mark_buffer_ = 0, face_buffer_ = 0;  // of vertices
  int frame_lines_ = 0;
  unsigned target_ = 0, colour_samples_ = 0, depth_samples_ = 0, resolved_ = 0, texture_ = 0;
  int width_ = 0, height_ = 0;
  std::array<float, 16> clip_from_world_{};
  std::uint64_t renders_ = 0;
};

}  // namespace sonoband::ui
