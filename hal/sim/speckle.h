// Scatterers fixed in tissue: a field of complex echoes, the same wherever and whenever it is looked at.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sonoband::sim {

struct Echo {
  float re = 0;
  float im = 0;
};

// Complex Gaussian noise, mean power 1, smoothed over space with a Gaussian of sigma 0.35 mm: two points d mm
// apart have correlation exp(-d^2 / 4 sigma^2), 0.6 at 0.5 mm and 0.13 at 1 mm. It repeats after 16 mm along
// x and, shifted, along y and z.
class SpeckleField {
 public:
  static constexpr float sigma_mm = 0.35F;
  static constexpr float voxel_mm = 0.25F;

  explicit SpeckleField(std::uint64_t seed);

  Echo at(const Eigen::Vector3f& p_mm) const {
    // The offset keeps the numbers positive for any phantom within 4 m, so that truncation is floor.
    constexpr float per_mm = 1 / voxel_mm;
    constexpr float offset = 16384;
    const auto x = static_cast<std::int32_t>(p_mm.x() * per_mm + offset);
    const auto y = static_cast<std::int32_t>(p_mm.y() * per_mm + offset);
    const auto z = static_cast<std::int32_t>(p_mm.z() * per_mm + offset);
    // Each repeat is shifted, or the eye finds the lattice.
    const std::int32_t shifted = x + 23 * (y >> 6) + 41 * (z >> 6);
    const std::int32_t index = ((z & 63) * 64 + (y & 63)) * 64 + (shifted & 63);
    const Packed e = field_[static_cast<std::size_t>(index)];
    return {static_cast<float>(e.re) * scale, static_cast<float>(e.im) * scale};
  }

 private:
  static constexpr float scale = 1.0F / 40;  // 40 is one standard deviation of the amplitude
  struct Packed {
    std::int8_t re;
    std::int8_t im;
  };
  std::vector<Packed> field_;
};

}  // namespace sonoband::sim
