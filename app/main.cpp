// sonoband: the cart.
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "app/bad_input.h"
#include "app/cart_on_board.h"
#include "app/chosen_board.h"
#include "app/freed_memory.h"
#include "app/live_stream.h"
#include "app/screen/run.h"
#include "app/script/examination.h"
#include "app/service_watch.h"
#include "app/workers.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband {
namespace {

struct Options {
  BoardChoice board;
  std::string script;
  std::string out = "out";
  std::string shots;
  std::filesystem::path exams = exam::default_exam_folder();
  std::string export_to;
  std::string size = "1280x800";
  float scale = 1;
  bool full_screen = false;
  bool headless = false;
  bool real_time = false;
  bool check = false;
  std::optional<std::uint16_t> igtl;
  std::string igtl_bind = "127.0.0.1";

  // A script needs nobody to watch it.
  bool window() const { return !headless && script.empty() && std::getenv("DISPLAY") != nullptr; }
};

int check(const Options& options) {
  const std::vector<CheckLine> lines = check_of(options.board);
  for (const CheckLine& line : lines) std::printf("%s\n", text_of(line).c_str());
  return all_found(lines) ? 0 : 1;
}

void print_losses(const nlohmann::ordered_json& ledger) {
  std::printf("Frames by cause:");
  for (const auto& [name, value] : ledger.items()) {
    if (value.get<std::uint64_t>() > 0)
      std::printf(" %s %llu", name.c_str(), value.get<unsigned long long>());
  }
  std::printf("\n");
}

ScreenOptions screen_options(const Options& options, const Profile& profile) {
  ScreenOptions screen;
  int used = 0;
  if (std::sscanf(options.size.c_str(), "%dx%d%n", &screen.width, &screen.height, &used) != 2 ||
      used != static_cast<int>(options.size.size()) || screen.width < 640 || screen.height < 480 ||
      screen.width > 8192 || screen.height > 8192) {
    throw BadInput("--size " + options.size + ": write width x height in pixels from 640x480 to 8192x8192");
  }
  // The only one that CLI11's range lets through.
  if (std::isnan(options.scale)) throw BadInput("--scale nan: write a number from 0.5 to 4");
  screen.full_screen = options.full_screen;
  screen.scale = options.scale;
  screen.bar = colour_bar_of(profile);
  screen.width_mm = static_cast<float>(profile.screen.width_mm);
  screen.shots = options.shots.empty() ? options.out : options.shots;
  screen.exports.folder = options.export_to.empty() ? profile.exams.export_to : options.export_to;
  // A cart's own disk is for recording; whoever tries the simulation has no stick at hand.
  if (screen.exports.folder.empty() && options.board.simulated())
    screen.exports.folder = screen.shots / "exports";
  screen.pedal = profile.pedal.mode;
  screen.version = SONOBAND_VERSION;
  return screen;
}

void examine(const Options& options, const std::vector<script::Step>& steps, const std::string& script_name,
             const BoardDevices& board, cart::Appliance& cart,
             const decltype(ScreenOptions::on_band)& on_band) {
  std::filesystem::create_directories(options.out);
  std::printf("A scripted examination on the board %s; pictures go to %s\n", board.board.c_str(),
              options.out.c_str());
  Workers workers(static_cast<int>(std::thread::hardware_concurrency()));
  script::Stage stage{cart, board.foot, board.views, cart.clock(), workers, options.out, on_band};
  nlohmann::ordered_json summary = script::run(steps, script_name, stage);
  summary["board"] = board.board;
  if (cart.exams() != nullptr) summary["exam"] = cart.exams()->exam_id();
  summary["note"] = "Research use only.";
  const std::filesystem::path file = std::filesystem::path(options.out) / "summary.json";
  std::ofstream out(file);
  out << summary.dump(1) << '\n';
  if (!out.flush())
    throw BadInput(file.string() + ": the summary cannot be written; choose another --out folder");
  print_losses(summary["ledger"]);
  std::printf("The pictures and the summary are in %s\n", std::filesystem::absolute(options.out).c_str());
}

// After the stop. Throws what is not saved, for the exit code.
void say_what_is_saved(const cart::Appliance& cart) {
  if (cart.exams() == nullptr) return;
  const exam::RecorderStatus saving = cart.exams()->status();
  if (!saving.sentence.empty()) throw BadInput(saving.sentence);
  if (saving.stored == 0) return;
  std::printf("The sweeps are saved: %s, exam %s, %lld frames\n", cart.exams()->place().c_str(),
              cart.exams()->exam_id().c_str(), static_cast<long long>(saving.stored));
}

ProbeOptions probe_of(const BoardDevices& board, const Profile& profile) {
  ProbeOptions probe;
  probe.name = board.board == "sim" ? "Simulated probe" : "Recorded probe";
  const auto [x, y, width, height] = profile.capture.crop_px;
  const bool whole = width == 0;
  probe.capture_width = board.width_px;
  probe.capture_height = board.height_px;
  probe.crop_px = {static_cast<float>(x), static_cast<float>(y),
                   static_cast<float>(whole ? board.width_px : width),
                   static_cast<float>(whole ? board.height_px : height)};
  probe.depth_mm = board.probe_from_image.linear.col(1).norm() * probe.crop_px.height;
  return probe;
}

// Tells what is sent, and to whom it can be heard.
std::unique_ptr<LiveStream> make_stream(const Options& options, cart::Appliance& cart,
                                        ScreenOptions& screen) {
  if (!options.igtl) return nullptr;
  exchange::IgtlSettings settings;
  settings.port = *options.igtl;
  settings.bind = options.igtl_bind;
  auto stream = std::make_unique<LiveStream>(cart, settings);
  std::printf("OpenIGTLink on %s, port %u%s\n", settings.bind.c_str(), stream->port(),
              stream->beyond_this_machine() ? ": whoever reaches this network can see the pictures" : "");
  std::fflush(stdout);
  screen.on_band = [s = stream.get()](const BandImage& band, const ReslicePlane& plane, int layers) {
    s->show_band(band, plane, layers);
  };
  screen.stream = [s = stream.get()] {
    return ui::StreamStatus{true, s->beyond_this_machine(), s->port(), s->status().clients};
  };
  return stream;
}

int run(const Options& options) {
  const Profile profile = profile_of(options.board);
  ScreenOptions screen = screen_options(options, profile);
  const bool window = options.window();
  if (!window && !options.headless && options.script.empty())
    std::printf("No display: DISPLAY is not set, so a scripted examination runs without a window\n");
  const std::string script_name = options.script.empty() ? "the default script" : options.script;
  const auto steps = options.script.empty() ? script::parse(script::default_text(), script_name)
                                            : script::read(options.script);

  std::shared_ptr<Clock> clock;
  // Real devices keep their own time.
  if (window || options.real_time || !options.board.simulated()) {
    clock = std::make_shared<SystemClock>();
  } else {
    clock = std::make_shared<sim::VirtualClock>();
  }
  BoardDevices board = devices_of(options.board, profile, *clock);
  screen.probe = probe_of(board, profile);
  const auto cart = make_appliance(board, profile, clock, options.exams);
  if (cart->exams() != nullptr) {
    for (const std::string& sentence : cart->exams()->recovered())
      std::fprintf(stderr, "sonoband: %s\n", sentence.c_str());
  }
  if (!cart->memory_warning().empty()) std::fprintf(stderr, "sonoband: %s\n", cart->memory_warning().c_str());
  const ClockMember member(*clock);
  const std::unique_ptr<LiveStream> stream = make_stream(options, *cart, screen);
  cart->start();
  if (!cart->priority_warning().empty())
    std::fprintf(stderr, "sonoband: %s\n", cart->priority_warning().c_str());
  std::optional<ServiceWatch> watch(std::in_place, [&cart] { return cart->beats(); });
  if (window) {
    CuePlayer cues(alsa_sink());
    run_window(*cart, board.foot, screen, board.touch.get(), &cues);
  } else if (script::needs_screen(steps)) {
    run_headless(*cart, board.foot, screen, steps, script_name, board.touch.get());
    std::printf("Played %s; its pictures are in %s\n", script_name.c_str(), screen.shots.c_str());
  } else {
    examine(options, steps, script_name, board, *cart, screen.on_band);
  }
  watch.reset();  // saving the last sweep may take longer than the manager's patience
  cart->stop();
  say_what_is_saved(*cart);
  return 0;
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  using namespace sonoband;
  keep_freed_memory();
  Options options;
  CLI::App app{"Sonoband: freehand 3D ultrasound at the cart. Research use only."};
  app.add_option("--board", options.board.board,
                 "sim, replay:FILE for a tracked sequence (.mha, .nrrd), cart, raspberrypi or virtual")
      ->capture_default_str();
  app.add_flag("--check", options.check,
               "say what is found of the board's devices, and how to cure what is not");
  app.add_option("--config", options.board.config,
                 "the machine's profile (TOML); board/README.md lists its keys");
  app.add_option("--calibration", options.board.calibration, "PLUS configuration (XML) for a replay");
  app.add_option("--exams", options.exams, "folder in which every sweep is saved; an empty name saves none")
      ->capture_default_str();
  app.add_option("--export-to", options.export_to,
                 "folder that Export offers besides sticks and cards; without it the profile's, and on the "
                 "simulated board exports in --shots");
  app.add_option("--size", options.size, "of the window, pixels")->capture_default_str();
  app.add_flag("--fullscreen", options.full_screen, "fill the display");
  app.add_option("--scale", options.scale, "of everything on the screen")
      ->check(CLI::Range(0.5F, 4.0F))
      ->capture_default_str();
  app.add_option("--shots", options.shots, "folder for snapshots of the screen; without it, --out");
  app.add_flag("--headless", options.headless, "no window: run a script");
  app.add_option("--script", options.script,
                 "what to run without a window; app/script/script.h has its language");
  app.add_option("--out", options.out, "folder for pictures and the summary")->capture_default_str();
  app.add_option(
      "--igtl", options.igtl,
      "send tracked frames, the band and the status to OpenIGTLink clients on this port; 18944 is usual, 0 "
      "any free one");
  app.add_option(
         "--igtl-bind", options.igtl_bind,
         "address to listen on; others than this machine's own loopback let the network see the pictures")
      ->capture_default_str();
  app.add_flag("--real-time", options.real_time,
               "simulate at the speed of the clock, not as fast as possible");
  try {
    app.parse(argc, argv);
    return options.check ? check(options) : run(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sonoband: %s\n", e.what());
    return 1;
  }
}
