#include "core/sweep/drawings.h"

#include <algorithm>

#include "core/image/overlay.h"

namespace sonoband {
namespace {

constexpr std::size_t most_looked_at = 32;

}  // namespace

bool probe_moved(std::span<const TrackedFrame* const> frames, int width, int height) {
  constexpr double enough_mm = 2;
  for (const double x : {0, width - 1}) {
    for (const double y : {0, height - 1}) {
      const auto corner = [&](const TrackedFrame& f) {
        return (f.world_from_image * Point<frame::Image>{{x, y, 0}}).v;
      };
      for (const TrackedFrame* f : frames)
        if ((corner(*f) - corner(*frames.front())).norm() >= enough_mm) return true;
    }
  }
  return false;
}

Pixels mask_without_drawings(const SweepView& sweep) {
  const auto& frames = sweep.frames;
  if (frames.empty() || frames.front()->bscan.kind != PixelKind::doppler) return both(sweep.mask, {});
  const ConstPixels& size = frames.front()->bscan.pixels;
  OverlayDetector detector(size.width, size.height);
  const std::size_t looks = std::min(frames.size(), most_looked_at);
  for (std::size_t i = 0; i < looks; ++i)
    detector.add_keys(frames[i * (frames.size() - 1) / std::max<std::size_t>(1, looks - 1)]->bscan.pixels);
  const bool moved = probe_moved(frames, size.width, size.height);
  return both(sweep.mask, detector.mask({}, moved).view());
}

}  // namespace sonoband
