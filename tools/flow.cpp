#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"
#include "tools/argument_checks.h"
#include "tools/curve_options.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::filesystem::path curve;
  std::filesystem::path out;
  double step_mm = 0.2;
  int layers = 0;
};

// Points of all layers together: 100 bytes of JSON each.
constexpr double max_points = 2e7;

nlohmann::json pair_of(const PlanePoint& p) {
  return {p.x(), p.y()};
}

nlohmann::json line_json(const PlaneLine& line) {
  auto json = nlohmann::json::array();
  for (const PlanePoint& p : line) json.push_back(pair_of(p));
  return json;
}

// Layer by layer, so that the text is never all in memory.
void write(const CurveFlow& flow, const std::filesystem::path& path) {
  exchange::FileBeside file(path);
  auto rulings = nlohmann::json::array();
  for (const RulingFoot& ruling : flow.rulings) rulings.push_back(pair_of(ruling.at));
  file.stream() << "{\"rulings\":" << rulings.dump() << ",\n\"layers\":[";
  for (const FlowLayer& layer : flow.layers) {
    auto front = nlohmann::json::array();
    for (const PlaneLine& line : layer.front) front.push_back(line_json(line));
    auto feet = nlohmann::json::array();
    for (const auto& foot : layer.feet) feet.push_back(foot ? pair_of(*foot) : nlohmann::json());
    file.stream() << (&layer == flow.layers.data() ? "\n" : ",\n") << "{\"k\":" << layer.k
                  << ",\"front\":" << front.dump() << ",\"feet\":" << feet.dump() << "}";
  }
  file.stream() << "\n]}\n";
  file.commit();
}

void flow(const Options& options, const CurveOptions& curve_options) {
  check_files_apart({{"--curve", options.curve}}, {{"--out", options.out}});
  const std::string file = options.curve.string();
  const CurveResult made = curve_of(read_curve_csv(options.curve), curve_options, options.step_mm);
  if (made.fault != CurveFault::none)
    throw BadInput(file + ": the curve " + std::string(describe(made.fault)));
  if (made.crosses_itself)
    std::fprintf(stderr,
                 "warning: %s: the curve crosses itself; near the crossing both passes share anatomy\n",
                 file.c_str());
  if (length_mm(made.curve) / options.step_mm * (2 * options.layers + 1) > max_points)
    throw BadInput(file +
                   ": the curve has too many rulings for so many layers; ask for fewer or larger steps");
  Serial serial;
  const CurveFlow result = flow_curve(made.curve,
                                      {.method = curve_options.method,
                                       .step_mm = options.step_mm,
                                       .layers = options.layers,
                                       .ruling_mm = options.step_mm,
                                       .fronts = Fronts::all},
                                      serial);
  write(result, options.out);
}

}  // namespace

void add_flow(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand(
      "flow",
      "The curves at equal distances beside a curve, and the point of each that goes with every ruling");
  verb->add_option(
          "--curve", options->curve,
          "File of lines x,y in mm; four or more points of which the last is the first close the curve")
      ->required();
  verb->add_option("--step-mm", options->step_mm, "Between layers, and between rulings along the curve")
      ->required()
      ->check(number_between(1e-4, 1e3));
  verb->add_option("--layers", options->layers, "On each side")
      ->required()
      ->check(CLI::Range(0, max_flow_layers));
  const auto curve_options = add_curve_options(*verb, "--method");
  verb->add_option("--out", options->out, "File to write (JSON): rulings, and fronts and feet of each layer")
      ->required();
  verb->callback([=] { flow(*options, *curve_options); });
}

}  // namespace sonoband::tools
