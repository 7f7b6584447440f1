#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/sim/phantom.h"

namespace sonoband::sim {

using Eigen::Vector3d;

GreyField constant(double grey) {
  return {[grey](const Vector3d&) { return grey; }};
}

GreyField ramp(double at_origin, const Vector3d& gradient_per_mm) {
  return {[at_origin, gradient_per_mm](const Vector3d& p) { return at_origin + gradient_per_mm.dot(p); }};
}

GreyField wires(std::vector<Wire> all, double sigma_mm) {
  return {[all = std::move(all), sigma_mm](const Vector3d& p) {
    double nearest2 = std::numeric_limits<double>::infinity();
    for (const Wire& w : all) {
      const Vector3d r = p - w.point;
      const double along = r.dot(w.direction);
      nearest2 = std::min(nearest2, r.squaredNorm() - along * along);
    }
    const double exponent = nearest2 / (2 * sigma_mm * sigma_mm);
    return 20 + (exponent < 20 ? 230 * std::exp(-exponent) : 0);
  }};
}

std::vector<Wire> n_wires() {
  std::vector<Wire> all;
  for (const double y : {20.0, 40.0, 60.0}) {
    const Vector3d left(-15, y, 0);
    const Vector3d right(15, y, 0);
    all.push_back({left, Vector3d::UnitZ()});
    all.push_back({right, Vector3d::UnitZ()});
    all.push_back({Vector3d(0, y, 0), Vector3d(30, 0, 100).normalized()});
  }
  all.push_back({Vector3d(5, 30, 0), Vector3d::UnitZ()});
  all.push_back({Vector3d(-5, 50, 0), Vector3d::UnitZ()});
  return all;
}

GreyField spheres(std::vector<Ball> all, double background) {
  return {[all = std::move(all), background](const Vector3d& p) {
    double grey = background;
    for (const Ball& b : all) {
      if ((p - b.centre).squaredNorm() <= b.radius_mm * b.radius_mm) grey = b.grey;
    }
    return grey;
  }};
}

std::vector<Ball> ball_rack() {
  return {{{-20, 30, -30}, 4, 220}, {{0, 30, -30}, 6, 180}, {{20, 30, -30}, 8, 140}, {{-20, 45, 0}, 8, 100},
          {{0, 45, 0}, 10, 255},    {{20, 45, 0}, 6, 200},  {{-15, 65, 30}, 10, 0},  {{15, 65, 30}, 5, 240}};
}

}  // namespace sonoband::sim
