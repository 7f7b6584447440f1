#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/exchange/png.h"
#include "app/exchange/sequence_file.h"
#include "app/exchange/text.h"
#include "app/workers.h"
#include "hal/clock.h"
#include "tools/plane_options.h"
#include "tools/render_options.h"
#include "tools/sweep_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

using Json = nlohmann::ordered_json;

struct Outputs {
  std::filesystem::path picture;
  std::filesystem::path coverage;
  std::filesystem::path json;
};

std::string commas(const Eigen::Vector3d& v) {
  return exchange::format_number(v.x()) + "," + exchange::format_number(v.y()) + "," +
         exchange::format_number(v.z());
}

Json plane_json(const ReslicePlane& plane, const std::string& world) {
  const auto three = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  return {{"origin", three(plane.origin.v)}, {"right", three(plane.right.v)},
          {"down", three(plane.down.v)},     {"size", {plane.width, plane.height}},
          {"pixel_mm", plane.pixel_mm},      {"world", world}};
}

// A line is kept for every row of every layer: 2^26 of them are 1.6 GB.
void check_size(const ReslicePlane& plane, const Band& band) {
  if (std::int64_t{plane.height} * band.layers() > std::int64_t{1} << 26 ||
      std::int64_t{plane.width} * plane.height > std::int64_t{1} << 28)
    throw CLI::ValidationError(
        "--size", "picture and band are too large together; take fewer pixels or a thinner band");
}

// Of all pixels, those with data in at least one layer.
double covered(const BandImage& image) {
  std::int64_t count = 0;
  for (int y = 0; y < image.coverage.height(); ++y)
    for (int x = 0; x < image.coverage.width(); ++x) count += image.coverage.view()(x, y) != 0;
  return static_cast<double>(count) / (static_cast<double>(image.coverage.width()) * image.coverage.height());
}

void write_json(const Json& json, const std::filesystem::path& path) {
  exchange::FileBeside file(path);
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  file.commit();
}

void render(const SweepOptions& sweep_options, const PlaneOptions& plane_options,
            const RenderOptions& render_options, const Outputs& out) {
  check_sweep_options(sweep_options);
  check_plane_options(plane_options);
  settings_of(render_options, 1);

  const exchange::SequenceSweep sweep = load_sweep(sweep_options);
  const SweepView view = sweep.view();
  const auto [plane, given] = choose_plane(plane_options, view);
  if (!given)
    std::printf("plane: --origin %s --right %s --down %s --size %dx%d --pixel-mm %s --world %s\n",
                commas(plane.origin.v).c_str(), commas(plane.right.v).c_str(), commas(plane.down.v).c_str(),
                plane.width, plane.height, exchange::format_number(plane.pixel_mm).c_str(),
                sweep.world.c_str());
  const RenderSettings settings = settings_of(render_options, pixel_width_mm(view));

  check_size(plane, settings.band);

  SystemClock clock;
  Workers workers(threads_of(render_options));
  const Stamp begin = clock.now();
  const BandImage image = [&, &plane = plane] {
    Progress progress("rendering");
    progress.show(0, 1);
    return render_planar(view, plane, settings, workers);
  }();
  const double milliseconds = seconds(clock.now() - begin) * 1e3;

  Json json{{"sequence", sweep_options.sequence.string()}, {"plane", plane_json(plane, sweep.world)}};
  json.update(settings_json(settings));
  json["frames"] = frames_json(sweep);
  json["coverage"] = covered(image);
  json["milliseconds"] = milliseconds;
  json["warnings"] = sweep.warnings;

  exchange::PngPicture picture = exchange::band_png(image);
  picture.pixel_mm = plane.pixel_mm;
  picture.texts = {{"Software", "sonoband-tool"},
                   {"Disclaimer", "research use only"},
                   {"Description", json["plane"].dump()},
                   {"Comment", settings_json(settings).dump()}};
  exchange::write_png(picture, out.picture);
  if (!out.coverage.empty()) {
    exchange::PngPicture coverage = exchange::coverage_png(image, settings.band.layers());
    coverage.pixel_mm = plane.pixel_mm;
    exchange::write_png(coverage, out.coverage);
  }
  if (!out.json.empty()) write_json(json, out.json);
  std::printf("%s: %d x %d pixels from %zu frames, %d layers, %.1f %% covered, %.1f ms\n",
              out.picture.c_str(), plane.width, plane.height, sweep.frames.size(), settings.band.layers(),
              100 * covered(image), milliseconds);
  for (const exchange::LeftOut& l : sweep.left_out)
    std::printf("left out: %d frames, %s\n", l.frames, l.cause.c_str());
}

}  // namespace

void add_render(CLI::App& tool) {
  CLI::App* verb =
      tool.add_subcommand("render", "Paint a slice, thin or thick, straight from the B-scans of a recording");
  const auto sweep = add_sweep_options(*verb);
  const auto plane = add_plane_options(*verb);
  const auto render_options = add_render_options(*verb);
  add_band_options(*verb, render_options);
  auto out = std::make_shared<Outputs>();
  verb->add_option("--out", out->picture, "Picture to write (PNG)")->required();
  verb->add_option("--coverage", out->coverage, "Where there is data (PNG): 0 none, 255 in every layer");
  verb->add_option("--json", out->json, "What was rendered, from what, how long it took (JSON)");
  verb->callback([=] { render(*sweep, *plane, *render_options, *out); });
}

}  // namespace sonoband::tools
