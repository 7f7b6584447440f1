// Planar bands on the work of tests/support/speed_sweep.h: plane, thickness, interpolation, threads.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "app/workers.h"
#include "core/reslice/band.h"
#include "tests/support/speed_sweep.h"

namespace sonoband {
namespace {

// Made once for each number of frames; the largest takes 1.2 GB.
const test::TestSweep& sweep_of(int frames) {
  static std::map<int, test::TestSweep> sweeps;
  auto found = sweeps.find(frames);
  if (found == sweeps.end()) {
    sweeps.clear();
    test::SpeedSweepOptions options;
    options.frames = frames;
    found = sweeps.emplace(frames, test::speed_sweep(options)).first;
  }
  return found->second;
}

void planar(benchmark::State& state, const ReslicePlane& plane, const RenderSettings& settings, int frames,
            int threads) {
  const SweepView view = sweep_of(frames).view();
  Workers workers(threads);
  for (auto _ : state) benchmark::DoNotOptimize(render_planar(view, plane, settings, workers));
}

RenderSettings settings_of(double thickness_mm, Interpolation interpolation, Compounding compounding) {
  RenderSettings settings;
  settings.band = {thickness_mm, 0.2};
  settings.interpolation = interpolation;
  settings.compounding = compounding;
  return settings;
}

void register_all() {
  const auto add = [](const std::string& name, auto body) {
    benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseRealTime();
  };
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    const std::string how = interpolation == Interpolation::nearest ? "nearest" : "linear";
    for (const double mm : {0.0, 14.0}) {
      for (const auto& [name, plane] : test::speed_planes()) {
        for (const int threads : {1, 2}) {
          add(how + (mm == 0 ? "/thin/" : "/14mm/") + name + "/threads:" + std::to_string(threads),
              [=, plane = plane](benchmark::State& state) {
                planar(state, plane, settings_of(mm, interpolation, Compounding::maximum), 200, threads);
              });
        }
      }
    }
  }
  for (const auto& [name, plane] : test::speed_planes()) {
    add("nearest/14mm/mean/" + name + "/threads:2", [plane = plane](benchmark::State& state) {
      planar(state, plane, settings_of(14, Interpolation::nearest, Compounding::mean), 200, 2);
    });
  }
  for (const int frames : {1000, 4000}) {
    for (const auto& [name, plane] : test::speed_planes()) {
      add("nearest/14mm/frames:" + std::to_string(frames) + "/" + name + "/threads:2",
          [=, plane = plane](benchmark::State& state) {
            planar(state, plane, settings_of(14, Interpolation::nearest, Compounding::maximum), frames, 2);
          });
    }
  }
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  sonoband::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
