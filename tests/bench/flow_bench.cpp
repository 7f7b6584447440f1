// Curve flow of 600 rulings and 36 layers on each side, and the making of a curve from a stroke.
#include <benchmark/benchmark.h>

#include <cmath>

#include "app/workers.h"
#include "core/manifold/flow.h"

namespace sonoband {
namespace {

// 600 rulings of 0.2 mm: a spine and bent legs, as a stroke of points 1 mm apart. `bend` in mm of depth.
Curve drawn(double bend, int rulings = 600) {
  std::vector<PlanePoint> stroke;
  const double length = 0.2 * (rulings - 1);
  double heading = 0;
  PlanePoint at(0, 0);
  for (double s = 0; s <= length; s += 0.5) {
    stroke.push_back(at);
    heading = bend * std::sin(2 * M_PI * s / 60) + 0.4 * bend * std::sin(2 * M_PI * s / 23 + 1);
    at += 0.5 * PlanePoint(std::cos(heading), std::sin(heading));
  }
  return make_curve(stroke, {.pixel_mm = 0.2}).curve;
}

void flow(benchmark::State& state, FlowMethod method, double bend, int threads, int rulings, Fronts fronts) {
  const Curve curve = drawn(bend, rulings);
  Workers workers(threads);
  const FlowSettings settings{
      .method = method, .step_mm = 0.2, .layers = 36, .ruling_mm = 0.2, .fronts = fronts};
  int64_t feet = 0;
  for (auto _ : state) {
    const CurveFlow result = flow_curve(curve, settings, workers);
    benchmark::DoNotOptimize(result.layers.back().feet.data());
    feet += static_cast<int64_t>(result.layers.size() * result.rulings.size());
  }
  state.counters["feet/s"] = benchmark::Counter(static_cast<double>(feet), benchmark::Counter::kIsRate);
  state.counters["edges"] = curve.edges();
}

void make(benchmark::State& state) {
  std::vector<PlanePoint> stroke;
  for (int i = 0; i < 240; ++i) stroke.emplace_back(0.5 * i, 5 * std::sin(0.05 * i));
  for (auto _ : state) benchmark::DoNotOptimize(make_curve(stroke, {.pixel_mm = 0.2}));
}

void register_all() {
  const auto add = [](const std::string& name, auto body) {
    benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseRealTime();
  };
  for (const int threads : {1, 2}) {
    const std::string end = "/threads:" + std::to_string(threads);
    for (const auto& [name, bend] : {std::pair{"gentle", 0.8}, std::pair{"tight", 2.0}})
      add(std::string("flow/exact/") + name + end, [=, b = bend](benchmark::State& state) {
        flow(state, FlowMethod::exact, b, threads, 600, Fronts::outermost);
      });
    add("flow/exact/gentle/all_fronts" + end,
        [=](benchmark::State& state) { flow(state, FlowMethod::exact, 0.8, threads, 600, Fronts::all); });
    add("flow/route_map/gentle" + end, [=](benchmark::State& state) {
      flow(state, FlowMethod::route_map, 0.8, threads, 600, Fronts::outermost);
    });
    add("flow/naive/gentle" + end, [=](benchmark::State& state) {
      flow(state, FlowMethod::naive, 0.8, threads, 600, Fronts::outermost);
    });
  }
  for (const int rulings : {300, 1200, 2400, 4800})
    add("flow/exact/gentle/rulings:" + std::to_string(rulings) + "/threads:1",
        [=](benchmark::State& state) { flow(state, FlowMethod::exact, 0.8, 1, rulings, Fronts::outermost); });
  add("make_curve/600", make);
}

}  // namespace
}  // namespace sonoband

int main(int argc, char** argv) {
  sonoband::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
