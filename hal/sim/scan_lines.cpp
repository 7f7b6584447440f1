#include "hal/sim/scan_lines.h"

#include <cmath>
#include <numbers>

namespace sonoband::sim {

using Eigen::Vector2d;

namespace {

constexpr double degree = std::numbers::pi / 180;

// Beam and sample of a place, fractional. Convex: the beam counts angle, the sample radius.
Vector2d beam_and_sample(const ScannerSettings& s, const ScanLines& lines, const Vector2d& px) {
  const Vector2d mm = (px - Vector2d((s.width_px - 1) / 2.0, s.face_row_px)) * s.pixel_mm;
  const double across = lines.beams - 1;
  if (s.array == ScannerSettings::Array::linear) {
    return {(mm.x() / s.face_width_mm + 0.5) * across, mm.y() / lines.sample_mm};
  }
  const Vector2d from_apex = mm + Vector2d(0, s.face_radius_mm);
  const double half = s.half_angle_deg * degree;
  const double angle = std::atan2(from_apex.x(), from_apex.y());
  return {(angle / half + 1) / 2 * across, (from_apex.norm() - s.face_radius_mm) / lines.sample_mm};
}

ScanLine scan_line(const ScannerSettings& s, const ScanLines& lines, int beam) {
  const Vector2d face((s.width_px - 1) / 2.0, s.face_row_px);
  const double u = static_cast<double>(beam) / (lines.beams - 1);
  const double step_px = lines.sample_mm / s.pixel_mm;
  if (s.array == ScannerSettings::Array::linear) {
    return {face + Vector2d((u - 0.5) * s.face_width_mm / s.pixel_mm, 0), Vector2d(0, step_px)};
  }
  const double angle = (2 * u - 1) * s.half_angle_deg * degree;
  const Vector2d direction(std::sin(angle), std::cos(angle));
  const double radius_px = s.face_radius_mm / s.pixel_mm;
  return {face - Vector2d(0, radius_px) + radius_px * direction, step_px * direction};
}

}  // namespace

ScanLines make_scan_lines(const ScannerSettings& s) {
  ScanLines lines;
  lines.beams = s.beams;
  lines.sample_mm = s.pixel_mm;
  lines.samples = static_cast<int>(std::ceil(s.depth_mm / lines.sample_mm)) + 1;
  for (int b = 0; b < lines.beams; ++b) lines.lines.push_back(scan_line(s, lines, b));

  for (int y = 0; y < s.height_px; ++y) {
    ScanLines::Run run{y, 0, 0, lines.taps.size()};
    const auto close = [&] {
      if (run.x_end > run.x_begin) lines.runs.push_back(run);
    };
    for (int x = 0; x < s.width_px; ++x) {
      const Vector2d at = beam_and_sample(s, lines, Vector2d(x, y));
      const bool inside =
          at.x() >= 0 && at.x() < lines.beams - 1 && at.y() >= 0 && at.y() < lines.samples - 1;
      if (!inside) continue;
      // A row of a convex picture may be cut in two by the face's curve.
      if (run.x_end != x || run.x_end == run.x_begin) {
        close();
        run = {y, x, x, lines.taps.size()};
      }
      const auto beam = static_cast<int>(at.x());
      const auto sample = static_cast<int>(at.y());
      lines.taps.push_back({static_cast<std::uint32_t>(sample * lines.beams + beam),
                            static_cast<std::uint8_t>((at.x() - beam) * 256),
                            static_cast<std::uint8_t>((at.y() - sample) * 256)});
      run.x_end = x + 1;
    }
    close();
  }
  return lines;
}

ScannerSettings abdominal() {
  return {};
}

ScannerSettings vascular() {
  ScannerSettings s;
  s.array = ScannerSettings::Array::linear;
  s.pixel_mm = 0.1;
  s.depth_mm = 45;
  s.focus_mm = 20;
  s.speckle_mm = 0.18;
  s.elevation_sigma_mm = 0.4;
  s.format = PixelFormat::rgb24;
  s.colour = ColourBox{.x = 150, .y = 100, .width = 340, .height = 250};
  return s;
}

Affine<frame::Face, frame::Image> face_from_image(const ScannerSettings& s) {
  Affine<frame::Face, frame::Image> a;
  a.linear = Eigen::Vector3d(s.pixel_mm, s.pixel_mm, 1).asDiagonal();
  a.translation = Eigen::Vector3d(-(s.width_px - 1) / 2.0 * s.pixel_mm, -s.face_row_px * s.pixel_mm, 0);
  return a;
}

Pixels body_mask(const ScannerSettings& s) {
  Pixels mask(s.width_px, s.height_px);
  for (const ScanLines::Run& run : make_scan_lines(s).runs) {
    for (int x = run.x_begin; x < run.x_end; ++x) mask.view()(x, run.y) = 255;
  }
  return mask;
}

}  // namespace sonoband::sim
