#include "ui/scene_geometry.h"

#include <algorithm>
#include <cmath>

namespace sonoband::ui {
namespace {

void set_colour(std::uint8_t* out, Colour c) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(c.rgba >> (24 - 8 * i) & 255);
}

}  // namespace

void SceneGeometry::add_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px) {
  SceneLine line{};
  for (int i = 0; i < 3; ++i) {
    line.a[i] = static_cast<float>(a[i] - sweep_.centre[i]);
    line.b[i] = static_cast<float>(b[i] - sweep_.centre[i]);
  }
  set_colour(line.rgba, c);
  line.width_px = width_px;
  lines_.push_back(line);
}

void SceneGeometry::add_dashed(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Colour c, float width_px,
                               double dash_mm) {
  const double all = (b - a).norm();
  if (!(all > 0) || !(dash_mm > 0)) return;
  const int count = std::clamp(static_cast<int>(std::round(all / (2 * dash_mm))), 1, 200);
  for (int i = 0; i < count; ++i) {
    add_line(a + (i + 0.25) / count * (b - a), a + (i + 0.75) / count * (b - a), c, width_px);
  }
}

void SceneGeometry::add_arch(const std::array<Eigen::Vector3d, 4>& corners, Colour c, float width_px) {
  add_line(corners[3], corners[0], c, width_px);
  add_line(corners[0], corners[1], c, width_px);
  add_line(corners[1], corners[2], c, width_px);
}

void SceneGeometry::add_quad(const std::array<Eigen::Vector3d, 4>& quad, Colour c) {
  constexpr std::array<int, 6> order = {0, 1, 2, 0, 2, 3};
  for (const int i : order) {
    SceneCorner corner{};
    for (int k = 0; k < 3; ++k) corner.at[k] = static_cast<float>(quad[i][k] - sweep_.centre[k]);
    set_colour(corner.rgba, c);
    corners_.push_back(corner);
  }
}

void SceneGeometry::make_outlines(const SceneInput& input, std::span<const int> shown,
                                  const SweepFrame& sweep) {
  sweep_ = sweep;
  lines_.clear();
  corners_.clear();
  for (const int i : shown) add_arch(corners_of(*input.frames[i]), colour::ink.with_alpha(0.5f), 1);
}

void SceneGeometry::make_marks(const SceneInput& input, const SweepFrame& sweep, float line_px) {
  sweep_ = sweep;
  lines_.clear();
  corners_.clear();
  if (input.current >= 0 && input.current < static_cast<int>(input.frames.size())) {
    add_arch(corners_of(*input.frames[input.current]), colour::current, 2.4f * line_px);
  }
  if (input.probe) add_arch(*input.probe, colour::current, 2.4f * line_px);
  if (!input.plane || input.plane->width < 1 || input.plane->height < 1) return;
  add_plane(input, *input.plane, line_px);
  add_surface(input, *input.plane, line_px);
}

void SceneGeometry::add_plane(const SceneInput& input, const ReslicePlane& p, float line_px) {
  const Eigen::Vector3d right = p.right.v * (p.width * p.pixel_mm);
  const Eigen::Vector3d down = p.down.v * (p.height * p.pixel_mm);
  const Eigen::Vector3d corner = p.origin.v - 0.5 * p.pixel_mm * (p.right.v + p.down.v);
  const Eigen::Vector3d normal = p.normal().v;
  const std::array<Eigen::Vector3d, 4> quad = {corner, corner + right, corner + right + down, corner + down};
  const auto edge = [&](const Eigen::Vector3d& off, bool dashed) {
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d a = quad[i] + off;
      const Eigen::Vector3d b = quad[(i + 1) % 4] + off;
      if (dashed) {
        add_dashed(a, b, colour::plane, line_px, 0.03 * sweep_.radius_mm);
      } else {
        add_line(a, b, colour::plane, 1.4f * line_px);
      }
    }
  };
  edge(Eigen::Vector3d::Zero(), false);
  if (input.thickness_mm > 0) {
    edge(0.5 * input.thickness_mm * normal, true);
    edge(-0.5 * input.thickness_mm * normal, true);
  }
  add_quad(quad, colour::plane.with_alpha(input.band_on_plane ? 0.10f : 0.30f));
}

void SceneGeometry::add_surface(const SceneInput& input, const ReslicePlane& p, float line_px) {
  const auto on_plane = [&](const Eigen::Vector2d& mm) {
    return Eigen::Vector3d(p.origin.v + mm.x() * p.right.v + mm.y() * p.down.v);
  };
  const Eigen::Vector3d reach = input.reach_mm * p.normal().v;
  for (std::size_t i = 0; i + 1 < input.curve_mm.size(); ++i) {
    const Eigen::Vector3d a = on_plane(input.curve_mm[i]);
    const Eigen::Vector3d b = on_plane(input.curve_mm[i + 1]);
    add_line(a, b, colour::accent, 2 * line_px);
    add_line(a + reach, b + reach, colour::accent, line_px);
    add_line(a - reach, b - reach, colour::accent, line_px);
    add_quad({a - reach, b - reach, b + reach, a + reach}, colour::accent.with_alpha(0.22f));
  }
}

}  // namespace sonoband::ui
