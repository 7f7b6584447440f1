#include "app/screen/drag_layers.h"

#include <algorithm>
#include <chrono>

namespace sonoband {
namespace {

// A thinner band is painted whole in less than the time of a block.
constexpr int least_layers = RollingBand::block_layers;
// A layer that is painted apart costs two to four times its share of the whole band.
constexpr int most_share = 4;

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point begun) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begun).count();
}

}  // namespace

bool DragLayers::pays(const ReslicePlane& plane, const RenderSettings& settings) const {
  return settings.band.layers() >= least_layers && RollingBand::most_bytes(plane, settings) <= most_bytes_;
}

void DragLayers::follow(std::uint64_t sweep_version, const GapLimit& gap) {
  if (sweep_version == sweep_version_ && gap.mm == gap_mm_) return;
  band_.clear();
  sweep_version_ = sweep_version;
  gap_mm_ = gap.mm;
}

std::optional<BandImage> DragLayers::render(PreparedSweep& sweep, const ReslicePlane& plane,
                                            const RenderSettings& settings, double whole_ms,
                                            Parallel& parallel) {
  if (!pays(plane, settings)) return std::nullopt;
  const std::optional<int> missing = band_.layers_missing(sweep, plane, settings);
  if (!missing) return std::nullopt;
  // Got ready they come in whole blocks, in a step one by one: whichever was dearer.
  const double layer_ms = std::max(ready_ms_, step_ms_);
  const bool cheaper = layer_ms > 0 && *missing * layer_ms < whole_ms;
  if (*missing * most_share > settings.band.layers() && !cheaper) return std::nullopt;
  const auto begun = Clock::now();
  BandImage band = band_.render(sweep, plane, settings, parallel);
  if (*missing > 0) step_ms_ = ms_since(begun) / *missing;
  return band;
}

void DragLayers::get_ready(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                           Parallel& parallel, const StopFlag& stop) {
  if (!pays(plane, settings)) return;
  const int missing = band_.layers_missing(sweep, plane, settings).value_or(0);
  const int before = missing > 0 ? band_.layers_painted() : 0;
  const auto begun = Clock::now();
  band_.prepare(sweep, plane, settings, parallel, &stop);
  const int painted = band_.layers_painted() - before;
  if (painted >= RollingBand::block_layers) ready_ms_ = ms_since(begun) / painted;
}

bool moved_along_normal(const ReslicePlane& from, const ReslicePlane& to) {
  constexpr double turned = 1e-6;  // as rolling bands allow
  constexpr double aside_mm = 1e-4;
  if ((from.right.v - to.right.v).norm() > turned || (from.down.v - to.down.v).norm() > turned ||
      from.width != to.width || from.height != to.height || from.pixel_mm != to.pixel_mm)
    return false;
  const Eigen::Vector3d moved = to.origin.v - from.origin.v;
  const Eigen::Vector3d normal = to.normal().v;
  return (moved - moved.dot(normal) * normal).norm() < aside_mm;
}

}  // namespace sonoband
