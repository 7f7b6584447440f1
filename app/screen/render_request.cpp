#include "app/screen/render_request.h"

#include <utility>

#include "app/screen/drag_layers.h"
#include "core/sweep/drawings.h"

namespace sonoband {

bool same_plane(const ReslicePlane& a, const ReslicePlane& b) {
  return a.origin.v == b.origin.v && a.right.v == b.right.v && a.down.v == b.down.v && a.width == b.width &&
         a.height == b.height && a.pixel_mm == b.pixel_mm;
}

bool same_look(const RenderRequest& a, const RenderRequest& b) {
  const RenderSettings& s = a.settings;
  const RenderSettings& t = b.settings;
  return a.sweep_version == b.sweep_version && s.band.thickness_mm == t.band.thickness_mm &&
         s.band.step_mm == t.band.step_mm && s.compounding == t.compounding &&
         s.interpolation == t.interpolation && s.gap.mm == t.gap.mm;
}

bool same_surface(const RenderRequest& a, const RenderRequest& b) {
  return same_look(a, b) && same_plane(a.curve_plane, b.curve_plane) && a.curve_mm == b.curve_mm &&
         a.reach_mm == b.reach_mm;
}

bool has_surface(const RenderRequest& request) {
  return request.curve_mm.size() > 1 && request.reach_mm > 0;
}

bool drags(const RenderRequest& from, const RenderRequest& to) {
  if (to.drag_ahead) return true;
  return to.moving && to.sweep_version == from.sweep_version && moved_along_normal(from.plane, to.plane) &&
         (!same_plane(from.plane, to.plane) ||
          from.settings.band.thickness_mm != to.settings.band.thickness_mm);
}

double samples_of(const RenderRequest& request) {
  return static_cast<double>(request.plane.width) * request.plane.height * request.settings.band.layers();
}

HeldSweep without_drawings(HeldSweep held) {
  struct Masked {
    std::shared_ptr<const void> frames;
    Pixels mask;
  };
  const auto& frames = held.view.frames;
  if (frames.empty() || frames.front()->bscan.kind != PixelKind::doppler) return held;
  auto masked =
      std::make_shared<const Masked>(Masked{std::move(held.keeper), mask_without_drawings(held.view)});
  held.view.mask = masked->mask.view();
  held.keeper = std::move(masked);
  return held;
}

}  // namespace sonoband
