#include "hal/sim/anatomy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace sonoband::sim {

using Eigen::Vector3f;

Anatomy::Anatomy(const Material& background, std::vector<Shape> shapes, const Vector3f& low,
                 const Vector3f& high, float cell_mm)
    : low_(low), per_mm_(1 / cell_mm) {
  assert(shapes.size() < std::numeric_limits<ShapeId>::max());
  shapes_.reserve(shapes.size() + 1);
  shapes_.emplace_back().material = background;
  shapes_.insert(shapes_.end(), shapes.begin(), shapes.end());

  const Eigen::Array3i n = ((high - low).array() * per_mm_).ceil().cast<int>().max(1);
  nx_ = n.x();
  ny_ = n.y();
  nz_ = n.z();
  size_ = n.cast<float>();
  cells_.resize(static_cast<std::size_t>(nx_) * ny_ * nz_);

  // A solid whose surface is farther from the cell's middle than its corners are holds all of it or none.
  const float corner = 0.5F * std::sqrt(3.0F) * cell_mm * 1.001F;
  std::vector<std::vector<ShapeId>> partial(cells_.size());
  for (std::size_t i = 1; i < shapes_.size(); ++i) {
    const Shape& s = shapes_[i];
    Vector3f from;
    Vector3f to;
    s.bounds(from, to);
    const Eigen::Array3f top = size_ - 1;
    const Eigen::Array3i first =
        ((from - low_).array() * per_mm_ - 1e-3F).floor().max(0).min(top + 1).cast<int>();
    const Eigen::Array3i last = ((to - low_).array() * per_mm_ + 1e-3F).floor().min(top).max(-1).cast<int>();
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          const Vector3f middle = low_ + (Eigen::Array3f(x, y, z) + 0.5F).matrix() * cell_mm;
          const float d = s.distance(middle);
          if (d > corner) continue;
          const auto index = (static_cast<std::size_t>(z) * ny_ + y) * nx_ + x;
          if (d < -corner) {
            cells_[index].base = static_cast<ShapeId>(i);
            partial[index].clear();
          } else {
            partial[index].push_back(static_cast<ShapeId>(i));
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].first = static_cast<std::uint32_t>(candidates_.size());
    assert(partial[i].size() <= std::numeric_limits<std::uint8_t>::max());
    cells_[i].count = static_cast<std::uint8_t>(partial[i].size());
    candidates_.insert(candidates_.end(), partial[i].rbegin(), partial[i].rend());
  }
  mark_calm();
}

void Anatomy::mark_calm() {
  const auto index = [this](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * ny_ + y) * nx_ + x;
  };
  for (int z = 1; z + 1 < nz_; ++z) {
    for (int y = 1; y + 1 < ny_; ++y) {
      for (int x = 1; x + 1 < nx_; ++x) {
        Cell& cell = cells_[index(x, y, z)];
        bool calm = true;
        for (int k = 0; k < 27 && calm; ++k) {
          const Cell& other = cells_[index(x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1)];
          calm = other.count == 0 && other.base == cell.base;
        }
        cell.calm = calm;
      }
    }
  }
}

}  // namespace sonoband::sim
