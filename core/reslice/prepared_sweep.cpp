#include "core/reslice/prepared_sweep.h"

#include "core/reslice/frame_table.h"
#include "core/reslice/paint.h"
#include "core/reslice/thinning.h"
#include "core/reslice/turned_frames.h"

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

void PreparedSweep::use_turned(const TurnedFrames* turned) {
  turned_ = turned;
  stale_ = true;
}

const FrameTable& PreparedSweep::prepare() {
  if (!stale_) return *table_;
  MaskSums sums = table_ ? std::move(table_->mask_sums) : MaskSums(mask_);
  table_ = std::make_unique<FrameTable>(make_frame_table({frames_, {}}, gap_));
  table_->mask = mask_;
  table_->mask_sums = std::move(sums);
  if (turned_ != nullptr) turned_->enter(*table_);
  thinned_table_.reset();
  stale_ = false;
  return *table_;
}

std::shared_ptr<const FrameTable> PreparedSweep::prepare_thinned(double pixel_mm,
                                                                 Interpolation interpolation) {
  prepare();
  if (thinned_table_ && thinned_pixel_mm_ == pixel_mm && thinned_for_ == interpolation) return thinned_table_;
  auto thinned = std::make_shared<FrameTable>(make_thinned_table(view(), gap_, pixel_mm, interpolation));
  if (turned_ != nullptr) turned_->enter(*thinned);
  thinned_table_ = std::move(thinned);
  thinned_pixel_mm_ = pixel_mm;
  thinned_for_ = interpolation;
  return thinned_table_;
}

namespace {

template <class Surface>
BandImage paint_prepared(PreparedSweep& sweep, const Surface& surface, const RenderSettings& settings,
                         double pixel_mm, Parallel& parallel, const StopFlag* stop) {
  if (!settings.thin_dense_frames) return paint(sweep.prepare(), surface, settings, parallel, stop);
  const std::shared_ptr<const FrameTable> kept = sweep.prepare_thinned(pixel_mm, settings.interpolation);
  return paint_thinned(sweep.prepare(), *kept, pixel_mm, surface, settings, parallel, stop);
}

}  // namespace

BandImage render_planar(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                        Parallel& parallel, const StopFlag* stop) {
  return paint_prepared(sweep, plane_lattice(plane, settings.band), settings, plane.pixel_mm, parallel, stop);
}

BandImage render_lines(PreparedSweep& sweep, const LineBundle& bundle, const RenderSettings& settings,
                       Parallel& parallel, const StopFlag* stop) {
  return paint_prepared(sweep, bundle, settings, bundle.step.v.norm(), parallel, stop);
}

}  // namespace sonoband
