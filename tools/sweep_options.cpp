#include "tools/sweep_options.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "app/exchange/sequence_file.h"
#include "app/exchange/text.h"
#include "tools/plane_options.h"

namespace sonoband::tools {

namespace {

void take_ramp(const std::string& colours, const std::string& option,
               std::array<doppler::Rgb, doppler::level_count>& levels) {
  if (colours.empty()) return;
  std::vector<doppler::Rgb> rgb;
  std::istringstream words(colours);
  for (std::string colour; words >> colour;) {
    const std::vector<double> n = comma_numbers(colour, 3, option);
    for (const double v : n)
      if (v != std::floor(v) || v < 0 || v > 255)
        throw CLI::ValidationError(option, "'" + colour + "' is no colour; give R,G,B, each from 0 to 255");
    rgb.push_back(
        {static_cast<std::uint8_t>(n[0]), static_cast<std::uint8_t>(n[1]), static_cast<std::uint8_t>(n[2])});
  }
  if (rgb.size() < 2)
    throw CLI::ValidationError(option, "one colour is no bar; give at least two, from dark to bright");
  levels = doppler::ramp(rgb);
}

exchange::SweepRequest request_of(const SweepOptions& o) {
  exchange::SweepRequest request;
  request.world = o.world;
  request.mask = o.mask != "none";
  request.colour = o.colour;
  request.bar = colour_bar(o);
  if (!o.frames.empty()) {
    const std::size_t dash = o.frames.find('-');
    const auto first = exchange::parse_integer(o.frames.substr(0, dash));
    const auto last = dash == std::string::npos ? first : exchange::parse_integer(o.frames.substr(dash + 1));
    if (!first || !last || *first < 0 || *last < *first || *last > 1'000'000'000)
      throw CLI::ValidationError("--frames",
                                 "'" + o.frames + "' is not A-B with A no more than B, counted from 0");
    request.frames = {static_cast<int>(*first), static_cast<int>(*last)};
  }
  if (!o.clip.empty()) {
    const auto n = comma_numbers(o.clip, 4, "--clip");
    for (const double v : n)
      if (v != std::floor(v) || std::abs(v) > 1e6)
        throw CLI::ValidationError("--clip", "'" + o.clip + "' is not whole pixels");
    if (n[2] < 1 || n[3] < 1)
      throw CLI::ValidationError("--clip", "width and height must be at least 1 pixel");
    request.clip = exchange::ClipRectangle{static_cast<int>(n[0]), static_cast<int>(n[1]),
                                           static_cast<int>(n[2]), static_cast<int>(n[3])};
  }
  return request;
}

}  // namespace

std::shared_ptr<SweepOptions> add_sweep_options(CLI::App& verb) {
  auto o = std::make_shared<SweepOptions>();
  verb.add_option("SEQ", o->sequence, "Sequence: .mha, .mhd or .nrrd")->required();
  verb.add_option("--calibration", o->calibrations,
                  "PLUS configuration (XML): its transforms, clip and fan; may be given again")
      ->expected(1)
      ->take_all();
  verb.add_option("--world", o->world,
                  "Frame to render in (default: Reference if there is one, else Tracker)");
  verb.add_option("--frames", o->frames, "A-B: only frames A to B, both included, counted from 0");
  verb.add_option("--clip", o->clip,
                  "X,Y,W,H: only these pixels of every picture, besides the configuration's");
  verb.add_option("--mask", o->mask, "none: every pixel counts, whatever clip and fan say")
      ->check(CLI::IsMember({"auto", "none"}));
  return o;
}

void add_colour_option(CLI::App& verb, const std::shared_ptr<SweepOptions>& options) {
  using exchange::ColourUse;
  options->colour = ColourUse::automatic;
  const std::map<std::string, ColourUse> names{
      {"auto", ColourUse::automatic}, {"doppler", ColourUse::doppler}, {"grey", ColourUse::grey}};
  verb.add_option("--colour", options->colour,
                  "An RGB recording's colours: doppler, grey, or auto (Doppler where it shows flow)")
      ->transform(one_of(names));
  verb.add_option(
      "--towards", options->towards,
      "The scanner's colour bar for flow towards the probe: \"R,G,B R,G,B ...\" from dark to bright "
      "(default: dark red, red, yellow)");
  verb.add_option("--away", options->away, "The same for flow away from it (default: dark blue, blue, cyan)");
}

doppler::ColourBar colour_bar(const SweepOptions& options) {
  doppler::ColourBar bar = doppler::red_blue_bar();
  take_ramp(options.towards, "--towards", bar.red);
  take_ramp(options.away, "--away", bar.blue);
  return bar;
}

void check_sweep_options(const SweepOptions& options) {
  request_of(options);
}

std::vector<NamedFile> files_read(const SweepOptions& options) {
  std::vector<NamedFile> files{{"SEQ", options.sequence}};
  for (const std::filesystem::path& path : options.calibrations) files.push_back({"--calibration", path});
  return files;
}

exchange::SequenceSweep load_sweep(const SweepOptions& options) {
  const exchange::SweepRequest request = request_of(options);
  const exchange::PlusConfig config = exchange::read_plus_configs(options.calibrations);
  exchange::SequenceSweep sweep = [&] {
    Progress progress("reading");
    progress.show(0, 1);
    return exchange::sweep_from_sequence(exchange::read_sequence(options.sequence), config, request,
                                         options.sequence.string());
  }();
  for (const std::string& warning : sweep.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  return sweep;
}

nlohmann::ordered_json frames_json(const exchange::SequenceSweep& sweep) {
  nlohmann::ordered_json json{{"used", sweep.frames.size()}, {"left_out", nlohmann::ordered_json::object()}};
  for (const exchange::LeftOut& l : sweep.left_out) json["left_out"][l.cause] = l.frames;
  json["world"] = sweep.world;
  json["links"] = sweep.links;
  return json;
}

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_ && last_percent_ >= 0) std::fprintf(stderr, "\r\033[K");
}

void Progress::show(int done, int all) {
  const int percent = all > 0 ? static_cast<int>(100LL * done / all) : 100;
  if (!terminal_ || percent == last_percent_) return;
  last_percent_ = percent;
  if (all == 1)
    std::fprintf(stderr, "\r%s ...", what_.c_str());
  else
    std::fprintf(stderr, "\r%s: %d %%", what_.c_str(), percent);
}

}  // namespace sonoband::tools
