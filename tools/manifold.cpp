#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/bad_input.h"
#include "app/exchange/png.h"
#include "app/workers.h"
#include "core/manifold/manifold_band.h"
#include "hal/clock.h"
#include "tools/argument_checks.h"
#include "tools/curve_options.h"
#include "tools/picture_output.h"
#include "tools/render_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct SurfaceOptions {
  std::string curve;
  double reach_mm = 0;
  std::filesystem::path smear;
};

// Memory that a picture may take, in pixels, and its lines, of 25 bytes each.
constexpr double max_pixels = 1 << 28;
constexpr double max_lines = 1 << 26;

[[noreturn]] void wrong(const std::string& option, const std::string& why) {
  throw CLI::ValidationError(option, why);
}

Curve surface_curve(const SurfaceOptions& surface, const CurveOptions& options, double pixel_mm) {
  CurveResult made = curve_of(curve_text(surface.curve, "--curve"), options, pixel_mm);
  if (made.fault != CurveFault::none) wrong("--curve", "the curve " + std::string(describe(made.fault)));
  if (made.crosses_itself)
    std::fprintf(stderr, "warning: the curve crosses itself; near the crossing both passes share anatomy\n");
  return std::move(made.curve);
}

void check_size(const Curve& curve, const ReslicePlane& plane, const SurfaceOptions& surface,
                const RenderSettings& settings) {
  const double rows = length_mm(curve) / plane.pixel_mm + 1;
  const double columns = 2 * surface.reach_mm / plane.pixel_mm + 1;
  const int layers = settings.band.layers();
  if (rows * columns > max_pixels || columns > max_curve_px)
    wrong("--reach-mm", "the picture would be too large; make the reach smaller or the pixels larger");
  if (layers > 2 * max_flow_layers + 1 || rows * layers > max_lines)
    wrong("--thickness-mm", "the band would have too many lines; make it thinner");
}

Json lines_json(const std::vector<PlaneLine>& lines) {
  Json json = Json::array();
  for (const PlaneLine& line : lines) {
    Json points = Json::array();
    for (const PlanePoint& p : line) points.push_back({p.x(), p.y()});
    json.push_back(std::move(points));
  }
  return json;
}

void write_smear(const ManifoldBand& band, double pixel_mm, const std::filesystem::path& path) {
  Pixels picture(band.image.pixels.width(), band.image.pixels.height());
  for (int row = 0; row < picture.height(); ++row)
    std::fill_n(picture.view().row(row), picture.width(), band.smeared[row]);
  exchange::PngPicture png = exchange::grey_png(picture.view());
  png.pixel_mm = pixel_mm;
  exchange::write_png(png, path);
}

void manifold(const SweepOptions& sweep_options, const PlaneOptions& plane_options,
              const RenderOptions& render_options, const SurfaceOptions& surface,
              const CurveOptions& curve_options, const PictureOutputs& out) {
  check_sweep_options(sweep_options);
  check_plane_options(plane_options);
  settings_of(render_options, 1);
  curve_text(surface.curve, "--curve");
  check_outputs(sweep_options, out, {{"--smear", surface.smear}});

  const exchange::SequenceSweep sweep = load_sweep(sweep_options);
  const SweepView view = sweep.view();
  const ReslicePlane plane = plane_of(plane_options, view, sweep.world);
  const RenderSettings settings = settings_of(render_options, pixel_width_mm(view));
  const Curve curve = surface_curve(surface, curve_options, plane.pixel_mm);
  check_size(curve, plane, surface, settings);

  SystemClock clock;
  Workers workers(threads_of(render_options));
  const Stamp begin = clock.now();
  const ManifoldBand band = render_manifold(
      view, plane, curve, {.reach_mm = surface.reach_mm, .flow = curve_options.method, .render = settings},
      workers);
  const double milliseconds = seconds(clock.now() - begin) * 1e3;

  Json json = picture_json(sweep_options, sweep, plane, settings, band.image, milliseconds);
  json["curve"] = {{"vertices", curve.vertices.size()},
                   {"length_mm", length_mm(curve)},
                   {"closed", curve.closed},
                   {"smooth_px", curve_options.smooth_px}};
  json["reach_mm"] = surface.reach_mm;
  json["flow"] = name_of(curve_options.method);
  json["rows"] = band.image.pixels.height();
  json["columns"] = band.image.pixels.width();
  json["smeared_rows"] = std::count(band.smeared.begin(), band.smeared.end(), 255);
  json["c_u"] = lines_json(band.up);
  json["c_d"] = lines_json(band.down);
  write_picture(band.image, colour_bar(sweep_options), settings, json, out);
  if (!surface.smear.empty()) write_smear(band, plane.pixel_mm, surface.smear);
  print_picture(sweep, settings, band.image, milliseconds, out);
}

}  // namespace

void add_manifold(CLI::App& tool) {
  CLI::App* verb = tool.add_subcommand(
      "manifold", "Paint and unroll a curved surface, thin or thick, that stands on a curve in a plane");
  const auto sweep = add_sweep_options(*verb);
  add_colour_option(*verb, sweep);
  const auto plane = add_plane_options(*verb);
  const auto render_options = add_render_options(*verb);
  add_band_options(*verb, render_options);
  auto surface = std::make_shared<SurfaceOptions>();
  verb->add_option(
          "--curve", surface->curve,
          "\"X,Y X,Y ...\" in plane mm (x along right, y along down from pixel (0,0)); row 0 is its start; "
          "four or more points of which the last is the first close it")
      ->required()
      ->group("Curve");
  verb->add_option("--reach-mm", surface->reach_mm, "How far the surface reaches to either side of the plane")
      ->required()
      ->check(number_between(0, 1e4))
      ->group("Curve");
  const auto curve_options = add_curve_options(*verb, "--flow");
  verb->add_option("--smear", surface->smear, "Which rows are smeared by a tight bend (PNG): 255, others 0")
      ->group("Curve");
  const auto out = add_picture_outputs(*verb);
  verb->callback([=] { manifold(*sweep, *plane, *render_options, *surface, *curve_options, *out); });
}

}  // namespace sonoband::tools
