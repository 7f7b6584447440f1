#include <chrono>
#include <memory>
#include <thread>

#include "app/exam/sweep_loader.h"
#include "app/exchange/igtl_server.h"
#include "tools/argument_checks.h"
#include "tools/exam_verbs.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

struct Options {
  std::string exam;
  std::filesystem::path folder;
  exchange::IgtlSettings server;
  std::int64_t sweep = 1;
  double seconds = 0;
  double speed = 1;
};

void serve(const Options& options) {
  const std::filesystem::path file = find_exam(options.exam, options.folder);
  exam::SweepLoader sweep(file, options.sweep);
  if (sweep.renderable().empty() && sweep.total() == 0)
    throw BadInput(file.filename().string() + ": the sweep has no frames to serve");
  sweep.wait();
  exchange::IgtlServer server(options.server);
  std::printf("OpenIGTLink on %s, port %u: %s, sweep %lld, again and again; Ctrl-C ends\n",
              options.server.bind.c_str(), server.port(), file.stem().c_str(),
              static_cast<long long>(options.sweep));
  std::fflush(stdout);
  server.set_status(true, "Research use only. Replay of " + file.stem().string());
  const Interruptible interruptible;
  const exam::SweepSetup& setup = sweep.setup();
  const Stamp first = sweep.frame(0).captured;
  const auto started = std::chrono::steady_clock::now();
  const auto over = [&] {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - started;
    return interruptible.asked_to_stop() || (options.seconds > 0 && passed.count() >= options.seconds);
  };
  for (auto round = started; !over();) {
    for (std::int64_t i = 0; i < sweep.total() && !over(); ++i) {
      const TrackedFrame& frame = sweep.frame(i);
      const Duration due(
          static_cast<std::int64_t>(static_cast<double>((frame.captured - first).count()) / options.speed));
      // In short sleeps, so that a wish to stop is heard at once.
      while (std::chrono::steady_clock::now() < round + due && !over())
        std::this_thread::sleep_until(
            std::min(round + due, std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
      if (!sweep.ready(i)) continue;
      exchange::IgtlFrame f;
      f.utc_ns = setup.pressed_utc_ns + (frame.captured - setup.pressed).count();
      f.pixels = frame.bscan.pixels;
      f.kind = frame.bscan.kind;
      f.world = setup.world;
      if (frame.pose_status == PoseStatus::ok) f.world_from_image = frame.world_from_image;
      f.tracker_from_probe = sweep.stored(i).record.tracker_from_probe;
      server.publish(f);
    }
    // A sweep of one picture is shown ten times a second.
    const auto next = std::chrono::steady_clock::now();
    if (next - round < std::chrono::milliseconds(100))
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    round = std::chrono::steady_clock::now();
  }
  const exchange::IgtlStatus status = server.status();
  std::printf("%llu messages; clients dropped: %llu too slow, %llu broken\n",
              static_cast<unsigned long long>(status.messages),
              static_cast<unsigned long long>(status.dropped_slow),
              static_cast<unsigned long long>(status.dropped_broken));
}

}  // namespace

void add_serve(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand(
      "serve", "Replay a sweep to OpenIGTLink clients, as often as it takes: pictures with their place");
  verb->add_option("EXAM", options->exam, "An exam's file, or its id")->required();
  verb->add_option("--exams", options->folder, "Folder in which an id is looked for")
      ->default_val(exam::default_exam_folder());
  verb->add_option("--igtl", options->server.port, "Port to listen on; 18944 is usual, 0 any free one")
      ->required();
  verb->add_option("--bind", options->server.bind,
                   "Address to listen on. Others than this machine's own loopback let the network see it")
      ->capture_default_str();
  verb->add_option("--sweep", options->sweep, "Which one, from 1")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--speed", options->speed, "Times the recording's own")
      ->check(number_between(0.01, 100))
      ->capture_default_str();
  verb->add_option("--for", options->seconds, "Seconds after which to end (default: never)")
      ->check(number_between(0, 1e9));
  verb->callback([options] { on_exams([&] { serve(*options); }); });
}

}  // namespace sonoband::tools
