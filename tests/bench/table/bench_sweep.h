// What the cases share: one sweep at a time, its voxel array, the threads.
#pragma once

#include <memory>

#include "app/workers.h"
#include "core/reslice/prepared_sweep.h"
#include "core/reslice/turned_frames.h"
#include "tests/bench/table/cases.h"
#include "tests/bench/table/peer.h"
#include "tests/support/speed_sweep.h"

namespace sonoband::bench {

struct BenchSweep {
  explicit BenchSweep(const TableOptions& o) : options(o), workers(o.threads) {}

  // The sweep of so many frames, with its voxel array where there is a peer; what is there already stays.
  void use(int frames, PixelKind kind = PixelKind::grey);

  TableOptions options;
  Workers workers;
  int frame_count = 0;
  std::unique_ptr<test::TestSweep> sweep;
  TurnedFrames turned;
  PreparedSweep prepared;
  VoxelArray array;
  std::unique_ptr<Peer> peer;

 private:
  void prepare();
  void load(int frames);
};

}  // namespace sonoband::bench
