#include "tests/bench/table/table.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>

#include "app/bad_input.h"
#include "app/exchange/file_beside.h"

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

namespace {

// A figure beside what is asked of it; a star where it misses that.
void print_figure(double value, const char* format, const Asked& asked, bool at_least) {
  const bool missed = asked.must > 0 && (at_least ? value < asked.must : value > asked.must);
  std::printf(format, value);
  std::printf("%s", missed ? "*" : " ");
  const auto words = [](double v) { return v > 0 ? fmt::format("{:g}", v) : std::string(); };
  std::printf("%5s %5s", words(asked.must).c_str(), words(asked.aim).c_str());
}

void put_asked(nlohmann::json& row, const Asked& asked, const std::string& what) {
  if (asked.must > 0) row["must_" + what] = asked.must;
  if (asked.aim > 0) row["aim_" + what] = asked.aim;
}

// Those whose names contain `filter`, and what they are multiples of.
std::vector<const Case*> chosen(const std::vector<Case>& cases, const std::string& filter) {
  const auto named = [&](const Case& c) { return c.name.find(filter) != std::string::npos; };
  std::set<std::string> bases;
  for (const Case& c : cases)
    if (named(c)) bases.insert(c.base);
  std::vector<const Case*> result;
  for (const Case& c : cases)
    if (named(c) || bases.contains(c.name)) result.push_back(&c);
  if (result.empty())
    throw BadInput("no case has '" + filter + "' in its name; run without --filter to see the names");
  return result;
}

}  // namespace

void measure(const std::vector<Case>& cases, const std::string& filter, const Output& output, Clock clock,
             int threads) {
  const std::vector<const Case*> rows = chosen(cases, filter);
  std::optional<exchange::FileBeside> file;
  if (!output.json_file.empty()) file.emplace(output.json_file);
  const auto time_ms = [&](const std::string& name, const std::function<void()>& body) {
    if (clock == Clock::wall) return wall_ms(name, body);
    double best = milliseconds(clock, threads, body);
    for (int repeat = 1; repeat < 12; ++repeat) best = std::min(best, milliseconds(clock, threads, body));
    return best;
  };
  nlohmann::json json{{"machine", machine()}, {"rows", nlohmann::json::array()}};
  if (!output.peer_name.empty()) json["peer"] = output.peer_name;
  std::printf("%s\npeer: %s\n\n%-60s %9s %6s %5s %9s %7s %6s %5s %7s %6s %5s %6s\n", machine().c_str(),
              output.peer_name.empty() ? "none" : output.peer_name.c_str(), "case", "ours ms", "must", "aim",
              "peer ms", "ratio", "must", "aim", "times", "must", "aim", "left out");
  std::map<std::string, double> measured;
  for (const Case* const row_case : rows) {
    const Case& c = *row_case;
    if (c.begin) c.begin();
    // Ours, the peer, ours: a machine whose speed drifts must not favour either.
    double ours = c.own_ms ? c.own_ms() : time_ms(c.name, c.ours);
    nlohmann::json row{{"case", c.name}};
    put_asked(row, c.ms, "ms");
    std::printf("%-60s ", c.name.c_str());
    double peer = 0;
    if (c.peer) {
      peer = time_ms(c.name, c.peer);
      if (!c.own_ms) ours = (ours + time_ms(c.name, c.ours)) / 2;
    }
    measured[c.name] = row["ours_ms"] = ours;
    print_figure(ours, "%9.3f", c.ms, false);
    if (c.peer) {
      row["vtk_ms"] = peer;
      row["ratio"] = peer / ours;
      put_asked(row, c.ratio, "ratio");
      std::printf(" %9.2f ", peer);
      print_figure(peer / ours, "%7.2f", c.ratio, true);
    } else if (!c.base.empty()) {
      std::printf("%30s", "");
    }
    if (!c.base.empty()) {
      const double times = ours / measured.at(c.base);
      row["base"] = c.base;
      row["times"] = times;
      put_asked(row, c.times, "times");
      std::printf(" ");
      print_figure(times, "%7.2f", c.times, false);
    }
    if (c.left_out) {
      const int frames = c.left_out();
      row["frames_left_out"] = frames;
      std::printf(" %6d", frames);
    }
    std::printf("\n");
    std::fflush(stdout);
    json["rows"].push_back(row);
  }
  if (!file) return;
  file->stream() << json.dump(1) << '\n';
  file->commit();
}

}  // namespace sonoband::bench
