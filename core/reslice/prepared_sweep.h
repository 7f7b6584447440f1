// A sweep made ready for many renderings, that may grow between them.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "core/reslice/band.h"

namespace sonoband {

struct FrameTable;
class TurnedFrames;

// Borrows frames, pictures and mask: they must outlive it. Not for two threads at once; renderings only read
// it.
class PreparedSweep {
 public:
  explicit PreparedSweep(const SweepView& sweep = {}, const GapLimit& gap = {});
  ~PreparedSweep();
  PreparedSweep(PreparedSweep&&) noexcept;
  PreparedSweep& operator=(PreparedSweep&&) noexcept;

  // Cheap: the next prepare() sees it. pose_status must be ok.
  void append(const TrackedFrame& frame);

  // Renderings from now on take the pictures that are kept turned there, of this sweep: they must stay until
  // the next call or the end. Null: none are.
  void use_turned(const TurnedFrames* turned);

  // Brings the tables up to date after append(): 0.1 ms for 200 frames. Gap limits of all frames may change,
  // because the automatic ones rest on the median over the sweep.
  const FrameTable& prepare();
  // The same of the frames that stay when thinned to a pixel (make_thinned_table in thinning.h); kept until
  // pixel or interpolation change. What is held stays as it is meanwhile: a picture that is shown while
  // another is painted may have other pixels.
  std::shared_ptr<const FrameTable> prepare_thinned(double pixel_mm, Interpolation interpolation);

  SweepView view() const { return {frames_, mask_}; }

 private:
  std::vector<const TrackedFrame*> frames_;
  MaskView mask_;
  GapLimit gap_;
  const TurnedFrames* turned_ = nullptr;
  bool stale_ = true;
  std::unique_ptr<FrameTable> table_;
  std::shared_ptr<const FrameTable> thinned_table_;
  double thinned_pixel_mm_ = 0;
  Interpolation thinned_for_ = Interpolation::nearest;
};

// Set by anyone at any time: painting ends before the next row of patches and the picture is incomplete.
using StopFlag = std::atomic<bool>;

// As in band.h, but for settings.gap, which is the sweep's. A null `stop` is never set.
BandImage render_planar(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                        Parallel& parallel, const StopFlag* stop = nullptr);
BandImage render_lines(PreparedSweep& sweep, const LineBundle& bundle, const RenderSettings& settings,
                       Parallel& parallel, const StopFlag* stop = nullptr);

}  // namespace sonoband
