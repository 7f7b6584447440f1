// The speed tables. Run through tools/bench.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "app/bad_input.h"
#include "app/freed_memory.h"
#include "tests/bench/table/cases.h"

int main(int argc, char** argv) {
  using namespace sonoband::bench;
  sonoband::keep_freed_memory();  // as the cart does
  CLI::App app{"Speed of narrow bands, ours beside a peer in one run"};
  TableOptions options;
  std::string json_file;
  std::string filter;
  app.add_flag("--peers", options.peers,
               "compare with VTK's slab rendering of a voxel array of the same sweep");
  app.add_option("--json", json_file, "write the rows as JSON to this file");
  app.add_option("--filter", filter, "only cases whose name contains this");
  app.add_option("--threads", options.threads, "threads of ours and of the peer")->check(CLI::Range(1, 64));
  bool processor_time = false;
  app.add_flag("--processor-time", processor_time,
               "processor time over the number of threads, best of 12: for a machine that others use");
  CLI11_PARSE(app, argc, argv);
  options.clock = processor_time ? Clock::processor : Clock::wall;
  try {
    const Table table = speed_table(options);
    if (options.peers && table.peer_name.empty())
      throw sonoband::BadInput("no peer was built in; run tools/bench --peers, which installs and builds it");
    measure(table.cases, filter, {table.peer_name, json_file}, options.clock, options.threads);
  } catch (const sonoband::BadInput& e) {
    std::fprintf(stderr, "tools/bench: %s\n", e.what());
    return 1;
  }
  return 0;
}
