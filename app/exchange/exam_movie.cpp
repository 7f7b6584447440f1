#include "app/exchange/exam_movie.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/bad_input.h"
#include "app/exchange/movie.h"
#include "core/reslice/default_plane.h"
#include "core/reslice/prepared_sweep.h"
#include "ui/interact/plane_motion.h"

namespace sonoband::exchange {
namespace {

void show(const Progress& progress, std::size_t done, std::size_t all, const std::filesystem::path& path) {
  if (progress && !progress(static_cast<int>(1000 * done / all)))
    throw BadInput(path.string() + ": stopped before the movie was whole; nothing is left of it");
}

// The B-scan as people see it.
PngPicture picture_of(const TrackedSequence& s, int i, PixelKind kind) {
  return picture_png({s.frame_pixels(i).data(), s.width, s.height, s.width}, kind);
}

// From its first frame on. Throws where they are not there, or go back.
std::vector<double> times_of(const TrackedSequence& sequence, const std::filesystem::path& path) {
  std::vector<double> times;
  for (const SequenceFrame& frame : sequence.frames) {
    const std::optional<double> time = timestamp_s(frame);
    if (!time || (!times.empty() && *time - times.front() < 0))
      throw BadInput(
          fmt::format("{}: frame {} has no time after the first one's, so there is no movie; export it as "
                      "mha or png",
                      path.string(), times.size()));
    times.push_back(*time);
  }
  const double first = times.front();
  for (double& t : times) t -= first;
  if (!std::is_sorted(times.begin(), times.end()))
    throw BadInput(path.string() +
                   ": the frames' times go back, so there is no movie; export it as mha or png");
  return times;
}

const char* name_of(Compounding c) {
  return c == Compounding::maximum ? "maximum" : c == Compounding::minimum ? "minimum" : "mean";
}

}  // namespace

void write_cine(const ExportedSweep& sweep, const std::string& source, const std::filesystem::path& path,
                int threads, const Progress& progress) {
  const TrackedSequence& s = sweep.sequence;
  if (s.frames.empty()) throw BadInput(path.string() + ": the sweep has no frames for a movie");
  const std::vector<double> times = times_of(s, path);
  // The last one is shown as long as the others were.
  const std::size_t n = times.size();
  const double last_s = n > 1 ? times.back() / static_cast<double>(n - 1) : 1;
  MovieSettings settings;
  settings.width = s.width;
  settings.height = s.height;
  if (sweep.setup.probe_from_image) {
    settings.x_mm = sweep.setup.probe_from_image->linear.col(0).norm();
    settings.y_mm = sweep.setup.probe_from_image->linear.col(1).norm();
  }
  settings.duration_s = times.back() + last_s;
  settings.threads = threads;
  settings.tags = {{"TITLE", source},
                   {"COMMENT", fmt::format("{} B-scans of freehand ultrasound, each at its own time", n)}};
  MovieWriter movie(path, settings);
  for (std::size_t i = 0; i < n; ++i) {
    movie.add(picture_of(s, static_cast<int>(i), sweep.setup.kind), times[i]);
    show(progress, i + 1, n, path);
  }
  movie.finish();
}

std::optional<ReslicePlane> turn_table_plane(const SweepView& sweep, TurnAxis axis, int most_px) {
  const auto begin = default_plane(sweep, PlaneView::upright);
  if (!begin) return std::nullopt;
  const Eigen::Vector3d middle = begin->origin.v + (begin->width - 1) * begin->pixel_mm / 2 * begin->right.v +
                                 (begin->height - 1) * begin->pixel_mm / 2 * begin->down.v;
  const Eigen::Vector3d u = axis == TurnAxis::down ? begin->down.v : begin->right.v;
  double radius = 0;
  double along = 0;
  for (const TrackedFrame* f : sweep.frames)
    for (const double x : {-0.5, f->bscan.pixels.width - 0.5})
      for (const double y : {-0.5, f->bscan.pixels.height - 0.5}) {
        const Eigen::Vector3d p = (f->world_from_image * Point<frame::Image>{{x, y, 0}}).v - middle;
        along = std::max(along, std::abs(p.dot(u)));
        radius = std::max(radius, (p - p.dot(u) * u).norm());
      }
  const double half_x = axis == TurnAxis::down ? radius : along;
  const double half_y = axis == TurnAxis::down ? along : radius;
  const double pixel_mm = std::max(pixel_width_mm(sweep), 2 * std::max(half_x, half_y) / (most_px - 1));
  ReslicePlane plane = *begin;
  plane.pixel_mm = pixel_mm;
  plane.width = static_cast<int>(2 * half_x / pixel_mm) + 1;
  plane.height = static_cast<int>(2 * half_y / pixel_mm) + 1;
  plane.origin.v = middle - (plane.width - 1) * pixel_mm / 2 * plane.right.v -
                   (plane.height - 1) * pixel_mm / 2 * plane.down.v;
  return plane;
}

ReslicePlane turned_about(const ReslicePlane& plane, TurnAxis axis, double angle_rad) {
  const Eigen::Vector2d middle_mm(0.5 * (plane.width - 1) * plane.pixel_mm,
                                  0.5 * (plane.height - 1) * plane.pixel_mm);
  return axis == TurnAxis::down ? ui::tilted(plane, 0, angle_rad, middle_mm)
                                : ui::tilted(plane, angle_rad, 0, middle_mm);
}

void write_turn_table(const SweepView& sweep, const TurnTable& turn, const std::string& source,
                      const std::filesystem::path& path, Parallel& parallel, const Progress& progress) {
  if (sweep.frames.empty())
    throw BadInput(path.string() +
                   ": no frame of the sweep has a place in space, so there is no band to turn");
  MovieSettings settings;
  settings.width = turn.plane.width;
  settings.height = turn.plane.height;
  settings.x_mm = settings.y_mm = turn.plane.pixel_mm;
  settings.duration_s = turn.pictures / turn.pictures_per_second;
  settings.threads = parallel.width();
  settings.tags = {
      {"TITLE", source + ", turn-table"},
      {"COMMENT", fmt::format("A band of {:g} mm, {}, {} pictures of one turn about the {} axis",
                              turn.settings.band.thickness_mm, name_of(turn.settings.compounding),
                              turn.pictures, turn.axis == TurnAxis::down ? "vertical" : "horizontal")}};
  PreparedSweep prepared(sweep, turn.settings.gap);
  MovieWriter movie(path, settings);
  for (int i = 0; i < turn.pictures; ++i) {
    const double angle = 2 * std::numbers::pi * i / turn.pictures;
    const BandImage band =
        render_planar(prepared, turned_about(turn.plane, turn.axis, angle), turn.settings, parallel);
    movie.add(band_png(band), i / turn.pictures_per_second);
    show(progress, static_cast<std::size_t>(i) + 1, static_cast<std::size_t>(turn.pictures), path);
  }
  movie.finish();
}

}  // namespace sonoband::exchange
