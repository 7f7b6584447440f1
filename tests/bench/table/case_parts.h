// What the files of cases share.
#pragma once

#include <memory>
#include <vector>

#include "tests/bench/table/bench_sweep.h"

namespace sonoband::bench {

using Shared = std::shared_ptr<BenchSweep>;

inline RenderSettings settings_of(Interpolation interpolation, Compounding compounding, double thickness_mm) {
  RenderSettings settings;
  settings.band = {thickness_mm, 0.2};
  settings.interpolation = interpolation;
  settings.compounding = compounding;
  return settings;
}

// Where lanes cannot follow pixel rows and the peer not its voxels' axes.
inline bool is_oblique(const test::NamedPlane& plane) {
  return plane.name == "oblique" || plane.name == "c45";
}

// Drags and changes of thickness (drag_cases.cpp).
void add_drags(const Shared& bench, std::vector<Case>& cases);

}  // namespace sonoband::bench
