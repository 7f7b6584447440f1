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

struct Case {
  std::string name;
  double must_ms = 0;              // what is asked of us on the agreed machine; 0: nothing is
  std::function<void()> ours;      // timed as a whole, several times over
  std::function<void()> peer;      // empty: none
  std::function<void()> begin;     // untimed, before the first of either; may be empty
  std::function<double()> own_ms;  // instead of `ours`: a figure of its own, such as the worst of many planes
};

// Measures and prints every case whose name contains `filter`, and writes the same as JSON to `json_file`
// unless it is empty:
// {"machine": ..., "peer": ..., "rows": [{"case", "ours_ms", "must_ms"?, "vtk_ms"?, "ratio"?}]}.
// Returns 0, or 1 when the file cannot be written.
int measure(const std::vector<Case>& cases, const std::string& filter, const std::string& peer_name,
            const std::string& json_file, Clock clock, int threads);

}  // namespace sonoband::bench
