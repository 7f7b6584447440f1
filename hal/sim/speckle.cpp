#include "hal/sim/speckle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/sim/random.h"

namespace sonoband::sim {

namespace {

constexpr int n = 64;

// Smooths along one axis of the periodic cube; `stride` is the axis'.
void smooth(std::vector<float>& field, int stride) {
  constexpr int reach = 5;
  constexpr double sigma = SpeckleField::sigma_mm / SpeckleField::voxel_mm;
  std::array<float, 2 * reach + 1> weight{};
  for (int i = -reach; i <= reach; ++i)
    weight[i + reach] = static_cast<float>(std::exp(-i * i / (2 * sigma * sigma)));
  std::array<float, n> line{};
  for (int start = 0; start < n * n * n; ++start) {
    if ((start / stride) % n != 0) continue;
    float* const first = field.data() + start;
    for (int i = 0; i < n; ++i) line[i] = first[i * stride];
    for (int i = 0; i < n; ++i) {
      float sum = 0;
      for (int k = -reach; k <= reach; ++k) sum += weight[k + reach] * line[(i + k + n) % n];
      first[i * stride] = sum;
    }
  }
}

std::vector<std::int8_t> component(std::uint64_t seed, float deviation) {
  std::vector<float> field(static_cast<std::size_t>(n) * n * n);
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<float>(gaussian(seed, i));
  for (const int stride : {1, n, n * n}) smooth(field, stride);
  double power = 0;
  for (const float v : field) power += static_cast<double>(v) * v;
  const auto gain = static_cast<float>(deviation / std::sqrt(power / static_cast<double>(field.size())));
  std::vector<std::int8_t> out(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    out[i] = static_cast<std::int8_t>(std::clamp(std::round(field[i] * gain), -127.0F, 127.0F));
  }
  return out;
}

}  // namespace

SpeckleField::SpeckleField(std::uint64_t seed) {
  // Half the power in each component.
  const auto deviation = static_cast<float>(std::sqrt(0.5)) / scale;
  const std::vector<std::int8_t> re = component(hash(seed, 0), deviation);
  const std::vector<std::int8_t> im = component(hash(seed, 1), deviation);
  field_.resize(re.size());
  for (std::size_t i = 0; i < re.size(); ++i) field_[i] = {re[i], im[i]};
}

}  // namespace sonoband::sim
