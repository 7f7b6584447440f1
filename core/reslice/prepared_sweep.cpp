#include "core/reslice/prepared_sweep.h"

#include "core/reslice/frame_table.h"
#include "core/reslice/paint.h"

namespace sonoband {

PreparedSweep::PreparedSweep(const SweepView& sweep, const GapLimit& gap)
    : frames_(sweep.frames.begin(), sweep.frames.end()), mask_(sweep.mask), gap_(gap) {}
PreparedSweep::~PreparedSweep() = default;
PreparedSweep::PreparedSweep(PreparedSweep&&) noexcept = default;
PreparedSweep& PreparedSweep::operator=(PreparedSweep&&) noexcept = default;

void PreparedSweep::append(const TrackedFrame& frame) {
  frames_.push_back(&frame);
  stale_ = true;
}

const FrameTable& PreparedSweep::prepare() {
  if (!stale_) return *table_;
  MaskSums sums = table_ ? std::move(table_->mask_sums) : MaskSums(mask_);
  table_ = std::make_unique<FrameTable>(make_frame_table({frames_, {}}, gap_));
  table_->mask = mask_;
  table_->mask_sums = std::move(sums);
  stale_ = false;
  return *table_;
}

BandImage render_planar(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                        Parallel& parallel, const StopFlag* stop) {
  return paint(sweep.prepare(), plane_lattice(plane, settings.band), settings, parallel, stop);
}

BandImage render_lines(PreparedSweep& sweep, const LineBundle& bundle, const RenderSettings& settings,
                       Parallel& parallel, const StopFlag* stop) {
  return paint(sweep.prepare(), bundle, settings, parallel, stop);
}

void render_progressively(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                          int factor, Parallel& parallel, const StopFlag* stop,
                          const std::function<void(BandImage, int factor)>& show) {
  const auto stopped = [&] { return stop != nullptr && stop->load(std::memory_order_relaxed); };
  if (factor > 1) {
    ReslicePlane coarse = plane;
    coarse.width = (plane.width + factor - 1) / factor;
    coarse.height = (plane.height + factor - 1) / factor;
    coarse.pixel_mm = plane.pixel_mm * factor;
    RenderSettings thinned = settings;
    thinned.band.step_mm = settings.band.step_mm * factor;
    // Layers of the coarse band are layers of the full one: no more than fit on either side of the middle.
    const int side = (settings.band.layers() - 1) / 2 / factor;
    thinned.band.thickness_mm = 2 * side * thinned.band.step_mm;
    BandImage image = render_planar(sweep, coarse, thinned, parallel, stop);
    if (stopped()) return;
    show(std::move(image), factor);
  }
  BandImage image = render_planar(sweep, plane, settings, parallel, stop);
  if (!stopped()) show(std::move(image), 1);
}

}  // namespace sonoband
