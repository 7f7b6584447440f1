// The work that speeds are quoted for, as cases of one table.
#pragma once

#include <vector>

#include "tests/bench/table/table.h"

namespace sonoband::bench {

struct TableOptions {
  int threads = 2;
  bool peers = false;
  Clock clock = Clock::wall;
};

// Sweeps and voxel arrays are made when a case first needs them and dropped when the next kind of sweep
// begins, so cases must be measured in order. The peer's name is empty without one.
struct Table {
  std::vector<Case> cases;
  std::string peer_name;
};
Table speed_table(const TableOptions& options);

}  // namespace sonoband::bench
