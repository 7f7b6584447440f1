// sonoband: the cart.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <thread>

#include "app/bad_input.h"
#include "app/cart_on_board.h"
#include "app/exchange/recording.h"
#include "app/exchange/sequence_file.h"
#include "app/script/examination.h"
#include "app/workers.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

struct Options {
  std::string board = "sim";
  std::string config;
  std::string calibration;
  std::string script;
  std::string out = "out";
  bool headless = false;
  bool real_time = false;
};

BoardDevices make_board(const Options& options, const Profile& profile, Clock& clock) {
  if (options.board == "sim") return make_sim_board(profile, clock);
  const std::string prefix = "replay:";
  if (!options.board.starts_with(prefix)) {
    throw BadInput("--board " + options.board +
                   ": there are the boards sim and replay:FILE; choose one of them");
  }
  const std::string file = options.board.substr(prefix.size());
  const exchange::PlusConfig config =
      options.calibration.empty() ? exchange::PlusConfig{} : exchange::read_plus_config(options.calibration);
  exchange::ReplayMaterial material = exchange::replay_material(exchange::read_sequence(file), config, file);
  for (const std::string& warning : material.warnings)
    std::fprintf(stderr, "sonoband: %s\n", warning.c_str());
  return make_replay_board(material.recording, material.probe_from_image, std::move(material.mask), profile,
                           clock);
}

void print_losses(const nlohmann::ordered_json& ledger) {
  std::printf("Frames by cause:");
  for (const auto& [name, value] : ledger.items()) {
    if (value.get<std::uint64_t>() > 0)
      std::printf(" %s %llu", name.c_str(), value.get<unsigned long long>());
  }
  std::printf("\n");
}

int examine(const Options& options) {
  const Profile profile = options.config.empty() ? Profile{} : read_profile(options.config);
  const std::string script_name = options.script.empty() ? "the default script" : options.script;
  const auto steps = options.script.empty() ? script::parse(script::default_text(), script_name)
                                            : script::read(options.script);
  std::filesystem::create_directories(options.out);

  std::shared_ptr<Clock> clock;
  if (options.real_time) {
    clock = std::make_shared<SystemClock>();
  } else {
    clock = std::make_shared<sim::VirtualClock>();
  }
  BoardDevices board = make_board(options, profile, *clock);
  const auto cart = make_appliance(board, profile, clock);
  if (!cart->memory_warning().empty()) std::fprintf(stderr, "sonoband: %s\n", cart->memory_warning().c_str());
  Workers workers(static_cast<int>(std::thread::hardware_concurrency()));

  std::printf("A scripted examination on the board %s; pictures go to %s\n", board.board.c_str(),
              options.out.c_str());
  nlohmann::ordered_json summary;
  {
    const ClockMember member(*clock);
    cart->start();
    script::Stage stage{*cart, board.foot, board.views, *clock, workers, options.out};
    summary = script::run(steps, script_name, stage);
    cart->stop();
  }
  summary["board"] = board.board;
  summary["note"] = "Research use only.";
  const std::filesystem::path file = std::filesystem::path(options.out) / "summary.json";
  std::ofstream out(file);
  out << summary.dump(1) << '\n';
  if (!out.flush())
    throw BadInput(file.string() + ": the summary cannot be written; choose another --out folder");
  print_losses(summary["ledger"]);
  std::printf("The pictures and the summary are in %s\n", std::filesystem::absolute(options.out).c_str());
  return 0;
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  using namespace sonoband;
  Options options;
  CLI::App app{"Sonoband: freehand 3D ultrasound at the cart. Research use only."};
  app.add_option("--board", options.board, "sim, or replay:FILE for a tracked sequence (.mha, .nrrd)")
      ->capture_default_str();
  app.add_option("--config", options.config, "the machine's profile (TOML); board/README.md lists its keys");
  app.add_option("--calibration", options.calibration, "PLUS configuration (XML) for a replay");
  app.add_flag("--headless", options.headless, "run a scripted examination without a window");
  app.add_option("--script", options.script, "the examination to run; app/script/script.h has its language");
  app.add_option("--out", options.out, "folder for pictures and the summary")->capture_default_str();
  app.add_flag("--real-time", options.real_time,
               "simulate at the speed of the clock, not as fast as possible");
  try {
    app.parse(argc, argv);
    return examine(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sonoband: %s\n", e.what());
    return 1;
  }
}
