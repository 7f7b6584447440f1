#include "tools/render_options.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <thread>

#include "app/exchange/text.h"
#include "tools/argument_checks.h"

namespace sonoband::tools {

namespace {

// 65 535 layers is what coverage counts to; 1 m is more than any sweep.
constexpr double max_mm = 1e3;
constexpr int max_layers = 65'535;

const std::map<std::string, Compounding>& compoundings() {
  static const std::map<std::string, Compounding> names{
      {"max", Compounding::maximum}, {"min", Compounding::minimum}, {"mean", Compounding::mean}};
  return names;
}

const std::map<std::string, Interpolation>& interpolations() {
  static const std::map<std::string, Interpolation> names{{"nearest", Interpolation::nearest},
                                                          {"linear", Interpolation::linear}};
  return names;
}

template <class Value>
std::string name_in(const std::map<std::string, Value>& names, Value value) {
  for (const auto& [name, v] : names)
    if (v == value) return name;
  return {};
}

}  // namespace

std::shared_ptr<RenderOptions> add_render_options(CLI::App& verb) {
  auto o = std::make_shared<RenderOptions>();
  verb.add_option("--interpolation", o->interpolation, "nearest (default) or linear")
      ->transform(one_of(interpolations()))
      ->group("Band");
  verb.add_option("--gap-mm", o->gap, "How far from a B-scan its pixels are used: mm or auto (default)")
      ->group("Band");
  verb.add_option("--threads", o->threads, "Threads (default: one for each processor)")
      ->check(CLI::Range(1, 256))
      ->group("Band");
  return o;
}

void add_band_options(CLI::App& verb, const std::shared_ptr<RenderOptions>& o) {
  verb.add_option("--thickness-mm", o->thickness_mm, "Thickness of the band (default 0: a thin slice)")
      ->check(number_between(0, max_mm))
      ->group("Band");
  verb.add_option("--compounding", o->compounding, "max (default), min or mean over the band's layers")
      ->transform(one_of(compoundings()))
      ->group("Band");
}

RenderSettings settings_of(const RenderOptions& o, double step_mm) {
  RenderSettings settings{.band = {.thickness_mm = o.thickness_mm, .step_mm = step_mm},
                          .compounding = o.compounding,
                          .interpolation = o.interpolation,
                          .gap = {}};
  if (o.thickness_mm / step_mm > max_layers - 2)
    throw CLI::ValidationError("--thickness-mm", "the band would have more than 65535 layers");
  if (o.gap != "auto") {
    const auto mm = exchange::parse_number(o.gap);
    if (!mm || !(*mm > 0 && *mm <= max_mm))
      throw CLI::ValidationError("--gap-mm", "'" + o.gap + "' is neither auto nor mm above 0");
    settings.gap.mm = *mm;
  }
  return settings;
}

int threads_of(const RenderOptions& options) {
  return options.threads > 0 ? options.threads
                             : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

nlohmann::ordered_json settings_json(const RenderSettings& s) {
  nlohmann::ordered_json json{
      {"band",
       {{"thickness_mm", s.band.thickness_mm}, {"step_mm", s.band.step_mm}, {"layers", s.band.layers()}}},
      {"compounding", name_in(compoundings(), s.compounding)},
      {"interpolation", name_in(interpolations(), s.interpolation)}};
  json["gap_mm"] = s.gap.mm ? nlohmann::ordered_json(*s.gap.mm) : nlohmann::ordered_json("auto");
  return json;
}

}  // namespace sonoband::tools
