#include "core/reslice/thinning.h"

#include <algorithm>

#include "core/reslice/corner_distances.h"

namespace sonoband {
namespace {

// Frames closer than this at a corner may cross.
constexpr double apart_mm = 1e-4;

// 1 or -1 where all corners of `after` lie on one side of `before`, else 0.
int side_of(const TrackedFrame& before, const TrackedFrame& after) {
  const std::array<double, 4> mm = corner_distances_mm(before, after);
  const auto [least, greatest] = std::minmax_element(mm.begin(), mm.end());
  return *least > apart_mm ? 1 : *greatest < -apart_mm ? -1 : 0;
}

}  // namespace

std::vector<const TrackedFrame*> thinned(const SweepView& sweep, double pixel_mm) {
  std::vector<const TrackedFrame*> kept;
  for (const auto& [id, of_sweep] : by_sweep(sweep)) {
    const TrackedFrame* last_kept = nullptr;
    for (std::size_t i = 0; i < of_sweep.size(); ++i) {
      const TrackedFrame* frame = sweep.frames[of_sweep[i]];
      const bool last = i + 1 == of_sweep.size();
      if (last_kept != nullptr && !last &&
          corner_distance_mm(*last_kept, *sweep.frames[of_sweep[i + 1]]) <= thinning_pixel * pixel_mm) {
        continue;
      }
      kept.push_back(frame);
      last_kept = frame;
    }
  }
  return kept;
}

std::vector<const TrackedFrame*> thinned_for_nearest(const SweepView& sweep, double pixel_mm) {
  const double most_mm = thinning_pixel * pixel_mm;
  std::vector<const TrackedFrame*> kept;
  for (const auto& in_order : by_sweep(sweep)) {
    const auto& of_sweep = in_order.second;  // clang 14 captures no structured bindings
    const std::size_t count = of_sweep.size();
    const auto frame = [&](std::size_t i) -> const TrackedFrame& { return *sweep.frames[of_sweep[i]]; };
    const auto neighbours = [&](std::size_t a, std::size_t b) {
      return corner_distance_mm(frame(a), frame(b - 1)) <= most_mm &&
             corner_distance_mm(frame(b), frame(a + 1)) <= most_mm;
    };
    kept.push_back(&frame(0));
    for (std::size_t a = 0; a + 1 < count;) {
      std::size_t b = a + 1;
      const int side = side_of(frame(a), frame(b));
      while (side != 0 && b + 1 < count && side_of(frame(b), frame(b + 1)) == side && neighbours(a, b + 1))
        ++b;
      kept.push_back(&frame(b));
      a = b;
    }
  }
  return kept;
}

FrameTable make_thinned_table(const SweepView& sweep, const GapLimit& gap, double pixel_mm,
                              Interpolation interpolation) {
  const std::vector<const TrackedFrame*> kept = interpolation == Interpolation::nearest
                                                    ? thinned_for_nearest(sweep, pixel_mm)
                                                    : thinned(sweep, pixel_mm);
  FrameTable table = make_frame_table({kept, sweep.mask}, gap);
  table.complete = kept.size() == sweep.frames.size();
  return table;
}

}  // namespace sonoband
