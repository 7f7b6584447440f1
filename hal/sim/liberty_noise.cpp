#include "hal/sim/liberty_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sonoband::sim {

TrackerNoise liberty_noise(double distance_mm) {
  struct Row {
    double distance_in, position_in, angle_deg;
  };
  constexpr std::array<Row, 5> table{{{12, 0.00005, 0.0004},
                                      {24, 0.0002, 0.0014},
                                      {36, 0.001, 0.0048},
                                      {48, 0.005, 0.0117},
                                      {72, 0.031, 0.06}}};
  constexpr double mm_per_inch = 25.4;
  const double d = std::max(distance_mm / mm_per_inch, table[0].distance_in);
  std::size_t row = 0;
  while (row + 2 < table.size() && d > table[row + 1].distance_in) ++row;
  const Row& a = table[row];
  const Row& b = table[row + 1];
  const double along = std::log(d / a.distance_in) / std::log(b.distance_in / a.distance_in);
  return {mm_per_inch * a.position_in * std::pow(b.position_in / a.position_in, along),
          a.angle_deg * std::pow(b.angle_deg / a.angle_deg, along)};
}

}  // namespace sonoband::sim
