#include "tests/bench/table/voxel_array.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sonoband::bench {
namespace {

struct Offset {
  int x, y, z, squared;
};

// The 124 neighbours of a 5^3 cube, nearest first.
std::vector<Offset> neighbours() {
  std::vector<Offset> offsets;
  for (int z = -2; z <= 2; ++z) {
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        const int squared = x * x + y * y + z * z;
        if (squared > 0) offsets.push_back({x, y, z, squared});
      }
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const Offset& a, const Offset& b) { return a.squared < b.squared; });
  return offsets;
}

std::uint8_t nearest_filled(const VoxelArray& a, int x, int y, int z, const std::vector<Offset>& offsets) {
  for (const Offset& o : offsets) {
    const int u = x + o.x;
    const int v = y + o.y;
    const int w = z + o.z;
    if (u < 0 || v < 0 || w < 0 || u >= a.nx || v >= a.ny || w >= a.nz) continue;
    const std::uint8_t value = a.voxels[a.index(u, v, w)];
    if (value != 0) return value;
  }
  return 0;
}

}  // namespace

VoxelArray array_for(const SweepView& sweep, double spacing_mm) {
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d most = -least;
  for (const TrackedFrame* f : sweep.frames) {
    for (const double x : {0.0, f->bscan.pixels.width - 1.0}) {
      for (const double y : {0.0, f->bscan.pixels.height - 1.0}) {
        const Eigen::Vector3d corner = (f->world_from_image * Point<frame::Image>{{x, y, 0}}).v;
        least = least.cwiseMin(corner);
        most = most.cwiseMax(corner);
      }
    }
  }
  const Eigen::Vector3d cells = ((most - least) / spacing_mm).array().ceil() + 1;
  VoxelArray array{least,
                   spacing_mm,
                   static_cast<int>(cells.x()),
                   static_cast<int>(cells.y()),
                   static_cast<int>(cells.z()),
                   {}};
  array.voxels.resize(static_cast<std::size_t>(array.nx) * array.ny * array.nz);
  return array;
}

void paste(const TrackedFrame& f, VoxelArray& array, Parallel& parallel) {
  // Pixel to voxel is affine: three additions a pixel.
  const Eigen::Vector3d step_x = f.world_from_image.linear.col(0) / array.spacing_mm;
  const Eigen::Vector3d step_y = f.world_from_image.linear.col(1) / array.spacing_mm;
  const Eigen::Vector3d start =
      (f.world_from_image.translation - array.origin_mm) / array.spacing_mm + Eigen::Vector3d::Constant(0.5);
  parallel.for_each(f.bscan.pixels.height, [&](int y) {
    const std::uint8_t* row = f.bscan.pixels.row(y);
    Eigen::Vector3d p = start + y * step_y;
    for (int x = 0; x < f.bscan.pixels.width; ++x, p += step_x) {
      const int u = static_cast<int>(p.x());
      const int v = static_cast<int>(p.y());
      const int w = static_cast<int>(p.z());
      if (u < 0 || v < 0 || w < 0 || u >= array.nx || v >= array.ny || w >= array.nz) continue;
      array.voxels[array.index(u, v, w)] = std::max<std::uint8_t>(row[x], 1);
    }
  });
}

VoxelArray fill_holes(const VoxelArray& array, Parallel& parallel) {
  const std::vector<Offset> offsets = neighbours();
  VoxelArray filled = array;
  parallel.for_each(array.nz, [&](int z) {
    for (int y = 0; y < array.ny; ++y) {
      for (int x = 0; x < array.nx; ++x) {
        std::uint8_t& value = filled.voxels[array.index(x, y, z)];
        if (value == 0) value = nearest_filled(array, x, y, z, offsets);
      }
    }
  });
  return filled;
}

}  // namespace sonoband::bench
