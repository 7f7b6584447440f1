// How far from a B-scan its pixels reach: given, or half the gap to its neighbours in the sweep.
#include <algorithm>
#include <cmath>

#include "core/reslice/band.h"
#include "core/reslice/corner_distances.h"

namespace sonoband {
namespace {

constexpr double jump_factor = 4;  // a lost contact or a pause is farther than this many median gaps

double half_pixel_mm(const TrackedFrame& f) {
  return f.world_from_image.linear.col(0).norm() / 2;
}

// Upper median; 0 of nothing.
double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// `of_sweep` are indices into frames of one sweep in order of capture.
void automatic_limits(const SweepView& sweep, const std::vector<int>& of_sweep, std::vector<double>& limits) {
  const std::size_t count = of_sweep.size();
  const auto frame = [&](std::size_t i) -> const TrackedFrame& { return *sweep.frames[of_sweep[i]]; };
  std::vector<double> to_next(count, 0.0);
  std::vector<double> to_previous(count, 0.0);
  std::vector<double> moves;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    to_next[i] = corner_distance_mm(frame(i), frame(i + 1));
    to_previous[i + 1] = corner_distance_mm(frame(i + 1), frame(i));
    for (const double mm : {to_next[i], to_previous[i + 1]}) {
      if (mm >= half_pixel_mm(frame(i))) moves.push_back(mm);
    }
  }
  const double typical = median(std::move(moves));
  for (std::size_t i = 0; i < count; ++i) {
    double gap = -1;
    if (i > 0 && to_previous[i] <= jump_factor * typical) gap = std::max(gap, to_previous[i]);
    if (i + 1 < count && to_next[i] <= jump_factor * typical) gap = std::max(gap, to_next[i]);
    if (gap < 0) gap = typical;
    limits[of_sweep[i]] = std::max(gap / 2, half_pixel_mm(frame(i)));
  }
}

}  // namespace

std::vector<double> gap_limits(const SweepView& sweep, const GapLimit& gap) {
  std::vector<double> limits(sweep.frames.size(), gap.mm.value_or(0.0));
  if (gap.mm) return limits;
  for (const auto& [id, of_sweep] : by_sweep(sweep)) automatic_limits(sweep, of_sweep, limits);
  return limits;
}

}  // namespace sonoband
