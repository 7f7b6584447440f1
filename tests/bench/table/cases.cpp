#include "tests/bench/table/cases.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "app/workers.h"
#include "core/reslice/band.h"
#include "tests/bench/table/peer.h"
#include "tests/support/speed_sweep.h"

namespace sonoband::bench {
namespace {

constexpr double voxel_mm =
    0.4;  // twice the pixel: the size peers' users choose; its slab renders no slower at 0.2

// What the cases share: one sweep at a time, its voxel array, the threads.
struct Bench {
  explicit Bench(const TableOptions& o) : options(o), workers(o.threads) {}

  void use(int frames) {
    if (sweep && frame_count == frames) return;
    peer.reset();
    test::SpeedSweepOptions sweep_options;
    sweep_options.frames = frames;
    sweep.reset();
    sweep = std::make_unique<test::TestSweep>(test::speed_sweep(sweep_options));
    frame_count = frames;
    if (!options.peers) return;
    array = array_for(sweep->view(), voxel_mm);
    for (const TrackedFrame* f : sweep->view().frames) paste(*f, array, workers);
    array = fill_holes(array, workers);
    peer = make_peer(array, options.threads);
  }

  TableOptions options;
  Workers workers;
  int frame_count = 0;
  std::unique_ptr<test::TestSweep> sweep;
  VoxelArray array;
  std::unique_ptr<Peer> peer;
};

using Shared = std::shared_ptr<Bench>;

RenderSettings settings_of(Interpolation interpolation, Compounding compounding, double thickness_mm) {
  RenderSettings settings;
  settings.band = {thickness_mm, 0.2};
  settings.interpolation = interpolation;
  settings.compounding = compounding;
  return settings;
}

std::string word(Interpolation i) {
  return i == Interpolation::nearest ? "nearest" : "linear";
}
std::string word(Compounding c) {
  return c == Compounding::maximum ? "max" : c == Compounding::minimum ? "min" : "mean";
}

Case planar(const Shared& bench, const test::NamedPlane& plane, const RenderSettings& settings, int frames,
            double must_ms) {
  Case c;
  c.name = "planar " + word(settings.interpolation) + " " + word(settings.compounding) + " " + plane.name +
           (settings.band.thickness_mm == 0 ? " thin" : "") + " N=" + std::to_string(frames);
  c.must_ms = must_ms;
  c.begin = [=] { bench->use(frames); };
  c.ours = [=] {
    benchmark::DoNotOptimize(render_planar(bench->sweep->view(), plane.plane, settings, bench->workers));
  };
  if (bench->options.peers) {
    c.peer = [=] { benchmark::DoNotOptimize(bench->peer->render(plane.plane, settings).data); };
  }
  return c;
}

void add_planar(const Shared& bench, std::vector<Case>& cases) {
  const auto planes = test::speed_planes();
  const auto oblique = [](const test::NamedPlane& p) { return p.name == "oblique" || p.name == "rotated45"; };
  for (const auto& plane : planes) {
    for (const Compounding how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
      cases.push_back(
          planar(bench, plane, settings_of(Interpolation::nearest, how, 14), 200, oblique(plane) ? 10 : 5));
    }
    cases.push_back(
        planar(bench, plane, settings_of(Interpolation::nearest, Compounding::maximum, 0), 200, 0));
    for (const Compounding how : {Compounding::maximum, Compounding::mean}) {
      cases.push_back(
          planar(bench, plane, settings_of(Interpolation::linear, how, 14), 200, oblique(plane) ? 20 : 10));
    }
  }
  for (const int frames : {1000, 4000}) {
    for (const auto& plane : planes) {
      for (const Interpolation how : {Interpolation::nearest, Interpolation::linear}) {
        cases.push_back(planar(bench, plane, settings_of(how, Compounding::maximum, 14), frames, 0));
      }
    }
  }
}

// From the last frame to the first picture: theirs pastes while scanning, so only the last frame, the holes
// and the slab count.
void add_first_picture(const Shared& bench, std::vector<Case>& cases) {
  const auto planes = test::speed_planes();
  const test::NamedPlane plane = planes.front();
  const RenderSettings settings = settings_of(Interpolation::nearest, Compounding::maximum, 14);
  Case c;
  c.name = "last frame to first picture N=200";
  c.must_ms = 20;
  c.begin = [=] { bench->use(200); };
  c.ours = [=] {
    benchmark::DoNotOptimize(render_planar(bench->sweep->view(), plane.plane, settings, bench->workers));
  };
  if (bench->options.peers) {
    c.peer = [=] {
      VoxelArray pasted = bench->array;
      paste(*bench->sweep->view().frames.back(), pasted, bench->workers);
      const VoxelArray filled = fill_holes(pasted, bench->workers);
      benchmark::DoNotOptimize(make_peer(filled, bench->options.threads)->render(plane.plane, settings).data);
    };
  }
  cases.push_back(c);
}

}  // namespace

Table speed_table(const TableOptions& options) {
  const auto bench = std::make_shared<Bench>(options);
  Table table;
  add_first_picture(bench, table.cases);
  add_planar(bench, table.cases);
  const VoxelArray empty = {Eigen::Vector3d::Zero(), 1, 2, 2, 2, std::vector<std::uint8_t>(8)};
  const auto peer = options.peers ? make_peer(empty, 1) : nullptr;
  table.peer_name = peer ? peer->name() : "none";
  return table;
}

}  // namespace sonoband::bench
