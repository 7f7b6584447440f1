// Drags along the normal and changes of thickness, by layers that are kept.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/reslice/rolling_band.h"
#include "tests/bench/table/case_parts.h"

namespace sonoband::bench {
namespace {

// Steps of a rolling band, each `moved` steps on from the plane and `layers` layers thicker than `from_mm`;
// the mean of all but the first, which paints the layers kept, or the first alone. Best of three drags.
struct Roll {
  int steps, moved, layers;
  double from_mm = 14;
};
Case rolling_case(const Shared& bench, const std::string& name, const ReslicePlane& plane, Asked ms,
                  const Roll& roll) {
  Case c;
  c.name = name;
  c.ms = ms;
  c.begin = [=] { bench->use(200); };
  c.own_ms = [=] {
    double best = 1e9;
    RollingBand rolling;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const auto step = [&](int i) {
        ReslicePlane at = plane;
        at.origin.v += 0.2 * (i * roll.moved) * at.normal().v;
        const RenderSettings settings =
            settings_of(Interpolation::nearest, Compounding::maximum, roll.from_mm + 0.2 * i * roll.layers);
        return milliseconds(bench->options.clock, bench->options.threads, [&] {
          benchmark::DoNotOptimize(rolling.render(bench->prepared, at, settings, bench->workers));
        });
      };
      ReslicePlane elsewhere = plane;
      elsewhere.origin.v += 50 * plane.right.v;
      rolling.render(bench->prepared, elsewhere, settings_of(Interpolation::nearest, Compounding::maximum, 0),
                     bench->workers);
      step(0);
      const double first = step(1);
      double sum = 0;
      for (int i = 2; i <= roll.steps; ++i) sum += step(i);
      best = std::min(best, roll.steps > 1 ? sum / (roll.steps - 1) : first);
    }
    return best;
  };
  return c;
}

}  // namespace

void add_drags(const Shared& bench, std::vector<Case>& cases) {
  for (const auto& plane : test::speed_planes()) {
    const Asked asked = is_oblique(plane) ? Asked{2, 1} : Asked{0.5, 0.2};
    const std::string end = " nearest max " + plane.name + " N=200";
    cases.push_back(rolling_case(bench, "drag by one pixel" + end, plane.plane, asked, {81, 1, 0}));
    cases.push_back(rolling_case(bench, "drag by one pixel, first step" + end, plane.plane, {}, {1, 1, 0}));
    cases.push_back(rolling_case(bench, "thickness by two layers" + end, plane.plane, asked, {21, 0, 2}));
    // At any thickness.
    for (const double mm : {2.0, 40.0})
      cases.push_back(rolling_case(bench, fmt::format("drag by one pixel, {:g} mm{}", mm, end), plane.plane,
                                   asked, {81, 1, 0, mm}));
  }
}

}  // namespace sonoband::bench
