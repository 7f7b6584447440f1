// The Outline window's picture: every B-scan's outline in space (an arch, its deep side open), the reslice
// plane with its band as a picture on it and the band's limits, the surface of the curve, the probe. Drawn
// with lines of even width, depth-tested, into a texture that is made anew only when something in it changes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ui/draw_kinds.h"
#include "ui/interact/outline_view.h"
#include "ui/pictures.h"
#include "ui/scene_geometry.h"

namespace sonoband::ui {

// A texture with the picture in a part of it, from its first texel; rows from the bottom.
struct SceneTexture {
  unsigned texture = 0;
  Vec2 part{1, 1};
  TextureKind kind;  // as it is drawn
};

class Scene {
 public:
  // So many B-scans lie on one another, and hide nothing behind them.
  static constexpr int crowd = 200;
  // Outlines closer than this are not all drawn: 2000 would take the software rasteriser a tenth of a second.
  static constexpr float least_apart_px = 2;

  Scene(Pictures& pictures, DrawKinds& kinds);  // needs a current context
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // The view the picture is made for, in pixels of a window at (0,0) of this size.
  OutlineView view(const SceneInput& input, const Rect& window);

  // The picture of the scene, `width` x `height`. `draw` fills it; until then what the input borrows must
  // stay.
  SceneTexture render(const SceneInput& input, int width, int height, float line_px);
  // Draws what was last asked for, if something in it has changed. Restores the framebuffer that was bound.
  void draw();

  std::uint64_t renders() const { return renders_; }  // since the start

 private:
  struct Key {
    std::uint64_t frames_version = 0, band_version = 0, marks_hash = 0;
    int current = 0, width = 0, height = 0;
    Orbit orbit;
    Look look;
    bool operator==(const Key&) const = default;
  };

  void make_target();
  SceneTexture texture() const;
  void send_frames(const SceneInput& input, const OutlineView& eye);
  void look_from(const OutlineView& eye);
  void draw_band(const SceneInput& input);
  void draw_lines(unsigned buffer, int count, float fade);
  void draw_marks(const SceneInput& input);

  Pictures& pictures_;
  DrawKinds& kinds_;
  SweepFrame sweep_;
  std::uint64_t sweep_version_ = 0;
  struct Sent {
    std::uint64_t frames_version = 0;
    int width = 0, height = 0;
    Orbit orbit;
    bool operator==(const Sent&) const = default;
  };
  Sent sent_;               // what the outlines in frame_buffer_ were chosen for
  std::vector<int> shown_;  // the B-scans they are of
  Key drawn_;
  bool drawn_once_ = false;
  SceneInput asked_;  // until it is drawn
  float asked_line_px_ = 1;
  bool waits_ = false;
  SceneGeometry geometry_;
  unsigned line_program_ = 0, face_program_ = 0;
  PicturePrograms band_programs_;
  unsigned line_vertices_ = 0, face_vertices_ = 0, no_vertices_ = 0;
  unsigned frame_buffer_ = 0, mark_buffer_ = 0, face_buffer_ = 0;  // of vertices
  int frame_lines_ = 0;
  unsigned target_ = 0, colour_samples_ = 0, depth_samples_ = 0, resolved_ = 0, texture_ = 0;
  int width_ = 0, height_ = 0;            // asked for last
  int made_width_ = 0, made_height_ = 0;  // there is room for
  std::array<float, 16> clip_from_world_{};
  std::uint64_t renders_ = 0;
};

}  // namespace sonoband::ui
