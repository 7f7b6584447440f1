// A body of many solids, and which of them holds a point, fast.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hal/sim/shapes.h"

namespace sonoband::sim {

// Solids in the order they are added: of several that hold a point the last one counts (put organs after the
// body, bones after organs). A grid of cells remembers which solids can matter in each, so that a look-up
// costs a few nanoseconds however many there are.
class Anatomy {
 public:
  using ShapeId = std::uint16_t;  // 0 is `background`

  // Cells of `cell_mm` cover what the box low..high holds; points outside it are background.
  Anatomy(const Material& background, std::vector<Shape> shapes, const Eigen::Vector3f& low,
          const Eigen::Vector3f& high, float cell_mm = 1.5F);

  ShapeId at(const Eigen::Vector3f& p_phantom) const {
    const Cell* cell = cell_at(p_phantom);
    if (cell == nullptr) return 0;
    const ShapeId* id = candidates_.data() + cell->first;
    for (int i = 0; i < cell->count; ++i, ++id) {
      if (shapes_[*id].contains(p_phantom)) return *id;
    }
    return cell->base;
  }

  // Where everything within cell_mm of the point is the same solid for sure, that one; else null.
  const ShapeId* calm_at(const Eigen::Vector3f& p_phantom) const {
    const Cell* cell = cell_at(p_phantom);
    return cell != nullptr && cell->calm ? &cell->base : nullptr;
  }
  float cell_mm() const { return 1 / per_mm_; }

  const Shape& shape(ShapeId id) const { return shapes_[id]; }
  const std::vector<Shape>& shapes() const { return shapes_; }

 private:
  void mark_calm();

  struct Cell {
    std::uint32_t first = 0;  // into candidates_: solids that hold part of the cell, the last added first
    std::uint8_t count = 0;
    bool calm = false;  // it and the 26 around it hold nothing but `base`
    ShapeId base = 0;   // the last added solid that holds all of it
  };
  const Cell* cell_at(const Eigen::Vector3f& p) const {
    const Eigen::Array3f c = (p - low_).array() * per_mm_;
    if (!((c >= 0).all() && (c < size_).all())) return nullptr;
    const int row = static_cast<int>(c.z()) * ny_ + static_cast<int>(c.y());
    return &cells_[static_cast<std::size_t>(row) * nx_ + static_cast<std::size_t>(c.x())];
  }

  std::vector<Shape> shapes_;  // [0] stands for the background
  Eigen::Vector3f low_;
  Eigen::Array3f size_;  // of the grid, in cells
  float per_mm_;
  int nx_;
  int ny_;
  int nz_;
  std::vector<Cell> cells_;
  std::vector<ShapeId> candidates_;
};

}  // namespace sonoband::sim
