#include "tests/bench/table/bench_sweep.h"

namespace sonoband::bench {
namespace {

constexpr double voxel_mm =
    0.4;  // twice the pixel: the size peers' users choose; its slab renders no slower at 0.2

}  // namespace

void BenchSweep::use(int frames, PixelKind kind) {
  if (!sweep || frame_count != frames) load(frames);
  if (sweep->frames().front()->bscan.kind == kind) return;
  for (const auto& frame : sweep->frames()) frame->bscan.kind = kind;
  prepare();
}

// As the cart has a sweep that is looked at: pictures are kept turned.
void BenchSweep::prepare() {
  prepared = PreparedSweep(sweep->view());
  turned.extend(sweep->view(), ~std::size_t{0}, workers);
  prepared.use_turned(&turned);
  prepared.prepare();
}

void BenchSweep::load(int frames) {
  peer.reset();
  prepared = PreparedSweep();
  turned.clear();
  test::SpeedSweepOptions sweep_options;
  sweep_options.frames = frames;
  sweep.reset();
  sweep = std::make_unique<test::TestSweep>(test::speed_sweep(sweep_options));
  frame_count = frames;
  prepare();
  if (!options.peers) return;
  array = array_for(sweep->view(), voxel_mm);
  for (const TrackedFrame* f : sweep->view().frames) paste(*f, array, workers);
  array = fill_holes(array, workers);
  peer = make_peer(array, options.threads);
}

}  // namespace sonoband::bench
