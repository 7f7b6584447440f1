#include "tests/bench/table/cases.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "core/manifold/manifold_band.h"
#include "tests/bench/table/case_parts.h"

namespace sonoband::bench {
namespace {

std::string word(Interpolation i) {
  return i == Interpolation::nearest ? "nearest" : "linear";
}
std::string word(Compounding c) {
  return c == Compounding::maximum ? "max" : c == Compounding::minimum ? "min" : "mean";
}

// Asked of bands of 200 frames, ms.
Asked asked_of(const test::NamedPlane& plane, const RenderSettings& settings) {
  if (settings.band.thickness_mm == 0) return {};
  if (settings.interpolation == Interpolation::linear) return {is_oblique(plane) ? 20.0 : 10.0, 10};
  return is_oblique(plane) ? Asked{10, 5} : Asked{5, 2};
}

std::string planar_name(const test::NamedPlane& plane, const RenderSettings& settings, int frames) {
  return "planar " + word(settings.interpolation) + " " + word(settings.compounding) + " " + plane.name +
         (settings.band.thickness_mm == 0 ? " thin" : "") + (settings.thin_dense_frames ? " thinned" : "") +
         " N=" + std::to_string(frames);
}

Case planar(const Shared& bench, const test::NamedPlane& plane, const RenderSettings& settings, int frames) {
  Case c;
  c.name = planar_name(plane, settings, frames);
  if (frames == 200) c.ms = asked_of(plane, settings);
  // Thin slices of a ready array are the peer's; of dense sweeps it must not be faster.
  if (settings.band.thickness_mm > 0) c.ratio.must = frames > 200 ? 1 : plane.name == "oblique" ? 10 : 3;
  if (settings.thin_dense_frames) {
    RenderSettings all = settings;
    all.thin_dense_frames = false;
    c.base = planar_name(plane, all, 200);
    c.times = {3, 1.5};
    c.left_out = [=] {
      return render_planar(bench->prepared, plane.plane, settings, bench->workers).frames_left_out;
    };
  } else if (frames > 200) {
    c.ratio = {};  // whole dense sweeps are only there to be compared
  }
  c.begin = [=] { bench->use(frames); };
  c.ours = [=] {
    benchmark::DoNotOptimize(render_planar(bench->prepared, plane.plane, settings, bench->workers));
  };
  if (bench->options.peers) {
    c.peer = [=] { benchmark::DoNotOptimize(bench->peer->render(plane.plane, settings).data); };
  }
  return c;
}

void add_planar(const Shared& bench, std::vector<Case>& cases) {
  const auto planes = test::speed_planes();
  for (const auto& plane : planes) {
    for (const Compounding how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
      cases.push_back(planar(bench, plane, settings_of(Interpolation::nearest, how, 14), 200));
    }
    cases.push_back(planar(bench, plane, settings_of(Interpolation::nearest, Compounding::maximum, 0), 200));
    for (const Compounding how : {Compounding::maximum, Compounding::mean}) {
      cases.push_back(planar(bench, plane, settings_of(Interpolation::linear, how, 14), 200));
    }
  }
}

// As many frames over the same way.
void add_dense(const Shared& bench, std::vector<Case>& cases) {
  for (const int frames : {1000, 4000}) {
    for (const auto& plane : test::speed_planes()) {
      for (const Interpolation how : {Interpolation::nearest, Interpolation::linear}) {
        cases.push_back(planar(bench, plane, settings_of(how, Compounding::maximum, 14), frames));
        RenderSettings thinned = settings_of(how, Compounding::maximum, 14);
        thinned.thin_dense_frames = true;
        cases.push_back(planar(bench, plane, thinned, frames));
      }
    }
  }
}

// What pictures that are kept turned cost, and what they save.
void add_turned(const Shared& bench, std::vector<Case>& cases) {
  const auto planes = test::speed_planes();
  const auto longitudinal =
      std::find_if(planes.begin(), planes.end(), [](const auto& p) { return p.name == "longitudinal"; });
  const RenderSettings settings = settings_of(Interpolation::nearest, Compounding::maximum, 14);
  Case without = planar(bench, *longitudinal, settings, 200);
  without.name = "planar nearest max longitudinal none kept turned N=200";
  without.peer = {};
  without.ratio = {};
  const auto plain = std::make_shared<PreparedSweep>();
  without.begin = [=] {
    bench->use(200);
    *plain = PreparedSweep(bench->sweep->view());
    plain->prepare();
  };
  without.ours = [=, plane = longitudinal->plane] {
    benchmark::DoNotOptimize(render_planar(*plain, plane, settings, bench->workers));
  };
  cases.push_back(without);
  Case turning;
  turning.name = "a picture turned to be kept";
  turning.ms.must = 0.5;
  turning.begin = [=] { bench->use(200); };
  turning.own_ms = [=] {
    TurnedFrames turned;
    Serial serial;
    return milliseconds(bench->options.clock, 1,
                        [&] { turned.extend(bench->sweep->view(), ~std::size_t{0}, serial); }) /
           bench->frame_count;
  };
  cases.push_back(turning);
}

// What a frame costs when it arrives, beside its turned picture: its place in the tables.
void add_arrival(const Shared& bench, std::vector<Case>& cases) {
  Case c;
  c.name = "a frame prepared on arrival, mean of 200";
  c.ms.must = 0.5;
  c.begin = [=] { bench->use(200); };
  c.own_ms = [=] {
    const SweepView view = bench->sweep->view();
    PreparedSweep growing({{}, view.mask});
    const auto arrive = [&] {
      for (const TrackedFrame* frame : view.frames) {
        growing.append(*frame);
        growing.prepare();
      }
    };
    return milliseconds(bench->options.clock, 1, arrive) / bench->frame_count;
  };
  cases.push_back(c);
}

// From the last frame to the first picture: theirs pastes while scanning, so only the last frame, the holes
// and the slab count.
void add_first_picture(const Shared& bench, std::vector<Case>& cases) {
  const auto planes = test::speed_planes();
  const test::NamedPlane& plane = planes.front();
  const RenderSettings settings = settings_of(Interpolation::nearest, Compounding::maximum, 14);
  Case c;
  c.name = "last frame to first picture N=200";
  c.ms = {20, 8};
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

// The slowest of 200 planes at any angle, each taken as the best of three.
void add_random_planes(const Shared& bench, std::vector<Case>& cases) {
  for (const Interpolation how : {Interpolation::nearest, Interpolation::linear}) {
    Case c;
    c.name = "planar " + word(how) + " max worst of 200 random planes N=200";
    c.ms = how == Interpolation::nearest ? Asked{10, 5} : Asked{20, 10};
    c.begin = [=] { bench->use(200); };
    c.own_ms = [=] {
      double worst = 0;
      for (const ReslicePlane& plane : test::random_planes(200, 1)) {
        double best = 1e9;
        for (int repeat = 0; repeat < 3; ++repeat) {
          best = std::min(
              best, milliseconds(bench->options.clock, bench->options.threads, [&] {
                benchmark::DoNotOptimize(render_planar(
                    bench->prepared, plane, settings_of(how, Compounding::maximum, 14), bench->workers));
              }));
        }
        worst = std::max(worst, best);
      }
      return worst;
    };
    cases.push_back(c);
  }
}

// 600 rulings of 480 samples along a curve that bends both ways, 7.2 mm: the work of the paper's Figure 12.
struct Unrolled {
  Unrolled() {
    for (int i = 0; i <= 200; ++i) stroke.emplace_back(8 + i * 0.52, 48 + 14 * std::sin(i * 0.035));
  }
  Curve curve() const { return make_curve(stroke, {.pixel_mm = 0.2, .smooth_px = 4, .closed = false}).curve; }
  CurveFlow flow(const Curve& c, Parallel& parallel) const {
    return band_flow(c, plane, settings.band, FlowMethod::exact, parallel);
  }
  BandImage band(const ReslicePlane& at, const Curve& c, const CurveFlow& flow, PreparedSweep& sweep,
                 Parallel& parallel) const {
    constexpr double reach_mm = 48;
    return render_lines(sweep, manifold_lines(at, c, flow, reach_mm, settings.band), settings, parallel);
  }

  std::vector<PlanePoint> stroke;
  ReslicePlane plane = test::speed_planes().front().plane;
  RenderSettings settings = settings_of(Interpolation::nearest, Compounding::maximum, 7.2);
};

void add_manifold(const Shared& bench, std::vector<Case>& cases) {
  const Unrolled u;
  const Curve curve = u.curve();
  Case flow;
  flow.name = "curve flow exact 7.2 mm";
  flow.ms = {4, 1};
  flow.ours = [=] { benchmark::DoNotOptimize(u.flow(curve, bench->workers)); };
  cases.push_back(flow);
  const auto add = [&](const std::string& name, const std::function<void()>& ours) {
    Case c;
    c.name = "manifold nearest max 7.2 mm " + name + "N=200";
    c.ms.must = 10;
    c.begin = [=] { bench->use(200); };
    c.ours = ours;
    cases.push_back(c);
  };
  add("", [=] {
    benchmark::DoNotOptimize(
        u.band(u.plane, curve, u.flow(curve, bench->workers), bench->prepared, bench->workers));
  });
  // The stroke is a curve and flows anew.
  add("a vertex moved ", [=, moved = u, by = 0.0]() mutable {
    by = by > 2 ? 0 : by + 0.2;
    moved.stroke[100].y() = u.stroke[100].y() + by;
    const Curve c = moved.curve();
    benchmark::DoNotOptimize(u.band(u.plane, c, u.flow(c, bench->workers), bench->prepared, bench->workers));
  });
  // The plane is dragged, or the band is thinner than before: the flow stays.
  add("its flow kept ",
      [=, kept = std::make_shared<CurveFlow>(u.flow(curve, bench->workers)), by = 0.0]() mutable {
        by = by > 2 ? 0 : by + 0.2;
        ReslicePlane at = u.plane;
        at.origin.v += by * at.normal().v;
        benchmark::DoNotOptimize(u.band(at, curve, *kept, bench->prepared, bench->workers));
      });
}

void add_doppler(const Shared& bench, std::vector<Case>& cases) {
  const test::NamedPlane plane = test::speed_planes().front();
  for (const Compounding how : {Compounding::maximum, Compounding::mean}) {
    Case c = planar(bench, plane, settings_of(Interpolation::nearest, how, 14), 200);
    // Maximum as grey (the same within what is measured), mean at most twice.
    c.base = c.name;
    c.times.must = how == Compounding::mean ? 2 : 1.1;
    c.ms = {};
    c.name = "doppler " + c.name;
    c.peer = {};
    c.ratio = {};
    c.begin = [=] { bench->use(200, PixelKind::doppler); };
    cases.push_back(c);
  }
}

}  // namespace

Table speed_table(const TableOptions& options) {
  const auto bench = std::make_shared<BenchSweep>(options);
  Table table;
  add_first_picture(bench, table.cases);
  add_drags(bench, table.cases);
  add_random_planes(bench, table.cases);
  add_manifold(bench, table.cases);
  add_arrival(bench, table.cases);
  add_turned(bench, table.cases);
  add_planar(bench, table.cases);
  add_doppler(bench, table.cases);
  add_dense(bench, table.cases);
  const VoxelArray empty = {Eigen::Vector3d::Zero(), 1, 2, 2, 2, std::vector<std::uint8_t>(8)};
  const auto peer = options.peers ? make_peer(empty, 1) : nullptr;
  table.peer_name = peer ? peer->name() : "";
  return table;
}

}  // namespace sonoband::bench
