// Cases measured with Google Benchmark and printed as one table: ours beside the peer, in one run, as a
// ratio.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sonoband::bench {

// What a figure is of. A shared machine's wall clock measures its other users.
enum class Clock {
  wall,       // median of 5 repetitions
  processor,  // processor time of all threads over their number, best of 12
};

// Of one run.
double milliseconds(Clock clock, int threads, const std::function<void()>& body);

// What is asked of a figure, and what is aimed at; 0: nothing is.
struct Asked {
  double must = 0;
  double aim = 0;
};

struct Case {
  std::string name;
  Asked ms;                        // on the agreed machine, at most
  Asked ratio;                     // of the peer's time to ours, at least
  std::string base;                // an earlier case of which `times` is a multiple; empty: none
  Asked times;                     // at most
  std::function<void()> ours;      // timed as a whole, several times over
  std::function<void()> peer;      // empty: none
  std::function<void()> begin;     // untimed, before the first of either; may be empty
  std::function<double()> own_ms;  // instead of `ours`: a figure of its own, such as the worst of many planes
  std::function<int()> left_out;   // frames that `ours` left out as denser than the output; may be empty
};

struct Output {
  std::string peer_name;  // empty: there is no peer
  std::string json_file;  // empty: none is written
};

// Measures and prints every case whose name contains `filter`, and those that they are multiples of; a figure
// that misses what is asked has a star. Writes the same as JSON: {"machine": ..., "peer"?: ...,
// "rows": [{"case", "ours_ms", "must_ms"?, "aim_ms"?, "vtk_ms"?, "ratio"?, "must_ratio"?, "base"?, "times"?,
// "must_times"?, "aim_times"?, "frames_left_out"?}]}; what is of the peer only where there is one. Throws
// BadInput where no case has such a name, or the file cannot be written, before anything is measured.
void measure(const std::vector<Case>& cases, const std::string& filter, const Output& output, Clock clock,
             int threads);

}  // namespace sonoband::bench
