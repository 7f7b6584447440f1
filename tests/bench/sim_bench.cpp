// What a frame of the simulated scanner costs: it runs beside everything else on the cart's own processor.
#include <benchmark/benchmark.h>

#include "hal/sim/scene.h"

namespace {

using namespace sonoband;
using namespace sonoband::sim;

void paint(benchmark::State& state, const char* preset) {
  const SimulatedScene scene = make_scene({.preset = preset});
  scene.hand->begin(Stamp{});
  const PaintFrame painter = scene.painter();
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(3 * 640 * 480));
  const int pixel_bytes = scene.scanner.format == PixelFormat::rgb24 ? 3 : 1;
  Duration t{};
  for (auto _ : state) {
    painter(Stamp(t), picture.data(), 640 * pixel_bytes);
    t += std::chrono::milliseconds(33);
    if (t > scene.hand->path().duration()) t = Duration(0);
  }
}
BENCHMARK_CAPTURE(paint, foetus, "foetus")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paint, vessels, "vessels")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paint, wires, "wires")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paint, ramp, "ramp")->Unit(benchmark::kMillisecond);

void build(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make_scene({.preset = "foetus"}).painter());
}
BENCHMARK(build)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
