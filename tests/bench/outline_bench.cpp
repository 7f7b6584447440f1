// The Outline window filling a screen of 1280 x 800 while a finger turns it: processor time of a frame with
// the software rasteriser, of sweeps of so many B-scans.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>

#include "app/screen/fonts.h"
#include "tests/support/test_sweep.h"
#include "ui/host/headless.h"
#include "ui/screen.h"

namespace sonoband {
namespace {

// Of 100 x 75 mm, 120 mm along a slow arc.
test::TestSweep arc(int frames) {
  test::TestSweep sweep;
  for (int i = 0; i < frames; ++i) {
    const double part = static_cast<double>(i) / frames;
    const Eigen::Matrix3d axes =
        Eigen::AngleAxisd(0.6 * (part - 0.5), Eigen::Vector3d::UnitX()).toRotationMatrix();
    sweep.add(8, 6, test::image_pose(axes, {0, 10 * std::sin(part * 3), 120 * part}, 12.5),
              [](int, int, const Eigen::Vector3d&) { return std::uint8_t{0}; });
  }
  return sweep;
}

void turn_the_outline(benchmark::State& state) {
  // On this thread, so that its share is in the figure.
  ::setenv("LP_NUM_THREADS", "0", 1);
  const test::TestSweep sweep = arc(static_cast<int>(state.range(0)));
  const SweepView frames = sweep.view();
  ui::HeadlessSurface surface(1280, 800);
  surface.begin_frame();
  ui::Screen screen(ui::ScreenSettings{}, load_fonts(), ui::Texts{});
  screen.warm_up(surface.size_px());
  ui::View view;
  view.page = ui::Page::review;
  view.review.full = ui::Window::outline;
  view.review.frames = frames.frames;
  view.review.sweep_version = 1;
  view.review.plane =
      *make_plane({20, 10, 10}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 200, 120, 0.5);
  Stamp now{std::chrono::seconds(1)};
  for (auto _ : state) {
    view.review.orbit.turn_rad += 0.02;
    now += std::chrono::milliseconds(16);
    surface.begin_frame();
    screen.frame(view, {}, now, surface.size_px());
    surface.finish();
  }
  state.counters["gl_errors"] = static_cast<double>(screen.counts().gl_errors);
}
BENCHMARK(turn_the_outline)->Arg(200)->Arg(2000)->Arg(8000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonoband

BENCHMARK_MAIN();
