#include "tools/picture_output.h"

#include <cstdio>

#include "app/exchange/file_beside.h"
#include "app/exchange/png.h"
#include "app/exchange/text.h"
#include "tools/render_options.h"

namespace sonoband::tools {

namespace {

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

// Of all pixels, those with data in at least one layer.
double covered(const BandImage& image) {
  std::int64_t count = 0;
  for (int y = 0; y < image.coverage.height(); ++y)
    for (int x = 0; x < image.coverage.width(); ++x) count += image.coverage.view()(x, y) != 0;
  return static_cast<double>(count) / (static_cast<double>(image.coverage.width()) * image.coverage.height());
}

}  // namespace

std::shared_ptr<PictureOutputs> add_picture_outputs(CLI::App& verb) {
  auto out = std::make_shared<PictureOutputs>();
  verb.add_option("--out", out->picture, "Picture to write (PNG)")->required();
  verb.add_option("--coverage", out->coverage, "Where there is data (PNG): 0 none, 255 in every layer");
  verb.add_option("--json", out->json, "What was rendered, from what, how long it took (JSON)");
  return out;
}

void check_outputs(const SweepOptions& sweep, const PictureOutputs& out, const std::vector<NamedFile>& more) {
  std::vector<NamedFile> written{{"--out", out.picture}, {"--coverage", out.coverage}, {"--json", out.json}};
  written.insert(written.end(), more.begin(), more.end());
  check_files_apart(files_read(sweep), written);
}

ReslicePlane plane_of(const PlaneOptions& options, const SweepView& sweep, const std::string& world) {
  const auto [plane, given] = choose_plane(options, sweep);
  if (!given)
    std::printf("plane: --origin %s --right %s --down %s --size %dx%d --pixel-mm %s --world %s\n",
                commas(plane.origin.v).c_str(), commas(plane.right.v).c_str(), commas(plane.down.v).c_str(),
                plane.width, plane.height, exchange::format_number(plane.pixel_mm).c_str(), world.c_str());
  return plane;
}

Json picture_json(const SweepOptions& options, const exchange::SequenceSweep& sweep,
                  const ReslicePlane& plane, const RenderSettings& settings, const BandImage& image,
                  double milliseconds) {
  Json json{{"sequence", options.sequence.string()}, {"plane", plane_json(plane, sweep.world)}};
  json.update(settings_json(settings));
  json["pixels"] = sweep.kind == PixelKind::doppler ? "doppler" : "grey";
  json["frames"] = frames_json(sweep);
  json["coverage"] = covered(image);
  json["milliseconds"] = milliseconds;
  json["warnings"] = sweep.warnings;
  return json;
}

void write_picture(const BandImage& image, const doppler::ColourBar& bar, const RenderSettings& settings,
                   const Json& json, const PictureOutputs& out) {
  const double pixel_mm = json["plane"]["pixel_mm"];
  exchange::PngPicture picture = exchange::band_png(image, bar);
  picture.pixel_mm = pixel_mm;
  picture.texts = {{"Software", "sonoband-tool"},
                   {"Disclaimer", "research use only"},
                   {"Description", json["plane"].dump()},
                   {"Comment", settings_json(settings).dump()}};
  exchange::write_png(picture, out.picture);
  if (!out.coverage.empty()) {
    exchange::PngPicture coverage = exchange::coverage_png(image, settings.band.layers());
    coverage.pixel_mm = pixel_mm;
    exchange::write_png(coverage, out.coverage);
  }
  if (!out.json.empty()) write_json(json, out.json);
}

void print_picture(const exchange::SequenceSweep& sweep, const RenderSettings& settings,
                   const BandImage& image, double milliseconds, const PictureOutputs& out) {
  std::printf("%s: %d x %d pixels from %zu frames, %d layers, %.1f %% covered, %.1f ms\n",
              out.picture.c_str(), image.pixels.width(), image.pixels.height(), sweep.frames.size(),
              settings.band.layers(), 100 * covered(image), milliseconds);
  for (const exchange::LeftOut& l : sweep.left_out)
    std::printf("left out: %d frames, %s\n", l.frames, l.cause.c_str());
  if (covered(image) == 0)
    std::fprintf(stderr,
                 "warning: no pixel has data: all of the picture lies beside the recording, or farther from "
                 "its B-scans than --gap-mm; without --origin a plane through its middle is taken\n");
}

void write_json(const Json& json, const std::filesystem::path& path) {
  exchange::FileBeside file(path);
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  file.commit();
}

}  // namespace sonoband::tools
