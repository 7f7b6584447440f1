#include "core/reslice/progressive.h"

#include <utility>
#include <vector>

namespace sonoband {
namespace {

// Runs bodies until `pause` says so, then `meanwhile` on the caller's thread, then the bodies that are left.
// Only the first such pause is made.
class Pausing final : public Parallel {
 public:
  Pausing(Parallel& inner, std::function<bool()> pause, std::function<void()> meanwhile)
      : inner_(inner), pause_(std::move(pause)), meanwhile_(std::move(meanwhile)) {}
  int width() const override { return inner_.width(); }
  void for_each(int count, const std::function<void(int)>& body) override {
    if (paused_) return inner_.for_each(count, body);
    std::vector<std::uint8_t> done(count);  // each written by one thread
    std::atomic<bool> pausing{false};
    inner_.for_each(count, [&](int i) {
      if (pausing.load(std::memory_order_relaxed)) return;
      if (pause_()) {
        pausing.store(true, std::memory_order_relaxed);
        return;
      }
      body(i);
      done[i] = 1;
    });
    if (!pausing) return;
    paused_ = true;
    meanwhile_();
    std::vector<int> left;
    for (int i = 0; i < count; ++i)
      if (done[i] == 0) left.push_back(i);
    inner_.for_each(static_cast<int>(left.size()), [&](int i) { body(left[i]); });
  }

 private:
  Parallel& inner_;
  std::function<bool()> pause_;
  std::function<void()> meanwhile_;
  bool paused_ = false;
};

}  // namespace

ReslicePlane coarse_plane(const ReslicePlane& plane, int factor) {
  ReslicePlane coarse = plane;
  coarse.width = (plane.width + factor - 1) / factor;
  coarse.height = (plane.height + factor - 1) / factor;
  coarse.pixel_mm = plane.pixel_mm * factor;
  return coarse;
}

Band coarse_band(const Band& band, int factor) {
  Band coarse;
  coarse.step_mm = band.step_mm * factor;
  // No more than fit on either side of the middle.
  const int side = (band.layers() - 1) / 2 / factor;
  coarse.thickness_mm = 2 * side * coarse.step_mm;
  return coarse;
}

void render_progressively(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                          const TimeBudget& budget, Parallel& parallel, const StopFlag* stop,
                          const std::function<void(BandImage, int factor)>& show) {
  const auto stopped = [&] { return stop != nullptr && stop->load(std::memory_order_relaxed); };
  const auto paint_full = [&](Parallel& with) {
    BandImage image = render_planar(sweep, plane, settings, with, stop);
    if (!stopped()) show(std::move(image), 1);
  };
  if (budget.factor < 2) return paint_full(parallel);
  RenderSettings fewer = settings;
  fewer.band = coarse_band(settings.band, budget.factor);
  BandImage coarse = render_planar(sweep, coarse_plane(plane, budget.factor), fewer, parallel, stop);
  if (stopped()) return;
  Pausing pausing(
      parallel, [&] { return !budget.spent || budget.spent(); },
      [&] {
        if (!stopped()) show(std::move(coarse), budget.factor);
      });
  paint_full(pausing);
}

}  // namespace sonoband
