#include "ui/theme.h"

namespace sonoband::ui {

Metrics metrics_for(int width_px, int height_px, float width_mm, float scale) {
  constexpr float usual_px_per_mm = 5.9f;
  constexpr float finger_mm = 9;
  constexpr float least_width_units = 840;  // below this the review tools no longer fit side by side
  constexpr float least_height_units = 520;
  Metrics m;
  m.screen = {0, 0, static_cast<float>(width_px), static_cast<float>(height_px)};
  m.px_per_mm = width_mm > 0 ? static_cast<float>(width_px) / width_mm : usual_px_per_mm;
  const float widest = std::min(m.screen.width / least_width_units, m.screen.height / least_height_units);
  m.unit = std::clamp(scale * m.px_per_mm / usual_px_per_mm, 0.5f, std::max(0.5f, widest));
  // With a mistaken size in the configuration everything must stay reachable: no target may eat the screen.
  m.target = std::min(std::max(finger_mm * m.px_per_mm, 46 * m.unit), m.screen.height / 9);
  return m;
}

}  // namespace sonoband::ui
