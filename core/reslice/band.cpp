#include "core/reslice/band.h"

#include <cmath>

namespace sonoband {

int Band::layers() const {
  return 2 * static_cast<int>(std::floor(thickness_mm / (2 * step_mm) + 0.5)) + 1;
}

double Band::offset_mm(int layer) const {
  const int middle = layers() / 2;
  return (layer - middle) * step_mm;
}

double pixel_width_mm(const SweepView& sweep) {
  return sweep.frames.empty() ? 0.0 : sweep.frames.front()->world_from_image.linear.col(0).norm();
}

}  // namespace sonoband
