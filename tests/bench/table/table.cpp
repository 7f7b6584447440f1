#include "tests/bench/table/table.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

namespace sonoband::bench {
namespace {

// Keeps the median of each benchmark's repetitions.
class Medians final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.aggregate_name == "median") ms[run.run_name.function_name] = run.GetAdjustedRealTime();
    }
  }
  std::map<std::string, double> ms;
};

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

std::string machine() {
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

double wall_ms(const std::string& name, const std::function<void()>& body) {
  benchmark::ClearRegisteredBenchmarks();
  benchmark::RegisterBenchmark(name.c_str(),
                               [&](benchmark::State& state) {
                                 for (auto _ : state) body();
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime()
      ->MinTime(0.05)
      ->Repetitions(5)
      ->ReportAggregatesOnly(true);
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  return medians.ms.at(name);
}

double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace

double milliseconds(Clock clock, int threads, const std::function<void()>& body) {
  if (clock == Clock::processor) {
    const double start = processor_ms();
    body();
    return (processor_ms() - start) / threads;
  }
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

int measure(const std::vector<Case>& cases, const std::string& filter, const std::string& peer_name,
            const std::string& json_file, Clock clock, int threads) {
  const auto time_ms = [&](const std::string& name, const std::function<void()>& body) {
    if (clock == Clock::wall) return wall_ms(name, body);
    double best = milliseconds(clock, threads, body);
    for (int repeat = 1; repeat < 12; ++repeat) best = std::min(best, milliseconds(clock, threads, body));
    return best;
  };
  nlohmann::json rows = nlohmann::json::array();
  std::printf("%s\npeer: %s\n\n%-52s %9s %9s %9s %8s\n", machine().c_str(), peer_name.c_str(), "case",
              "ours ms", "must ms", "peer ms", "ratio");
  for (const Case& c : cases) {
    if (c.name.find(filter) == std::string::npos) continue;
    if (c.begin) c.begin();
    // Ours, the peer, ours: a machine whose speed drifts must not favour either.
    double ours = c.own_ms ? c.own_ms() : time_ms(c.name, c.ours);
    nlohmann::json row{{"case", c.name}};
    std::printf("%-52s ", c.name.c_str());
    const std::string must = c.must_ms > 0 ? std::to_string(c.must_ms).substr(0, 5) : "";
    if (c.must_ms > 0) row["must_ms"] = c.must_ms;
    if (c.peer) {
      const double peer = time_ms(c.name, c.peer);
      if (!c.own_ms) ours = (ours + time_ms(c.name, c.ours)) / 2;
      row["vtk_ms"] = peer;
      row["ratio"] = peer / ours;
      std::printf("%9.3f %9s %9.2f %8.2f\n", ours, must.c_str(), peer, peer / ours);
    } else {
      std::printf("%9.3f %9s\n", ours, must.c_str());
    }
    row["ours_ms"] = ours;
    rows.push_back(row);
    std::fflush(stdout);
  }
  if (json_file.empty()) return 0;
  std::ofstream out(json_file);
  out << nlohmann::json{{"machine", machine()}, {"peer", peer_name}, {"rows", rows}}.dump(1) << '\n';
  if (out.good()) return 0;
  std::fprintf(stderr, "tools/bench: %s cannot be written; name a file in a folder that exists\n",
               json_file.c_str());
  return 1;
}

}  // namespace sonoband::bench
