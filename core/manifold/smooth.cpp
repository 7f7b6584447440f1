#include "core/manifold/smooth.h"

#include <cmath>

namespace sonoband {

namespace {

// Weights for offsets 0..radius, of sum 1 over both sides.
std::vector<double> gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> weights(radius + 1);
  double sum = 0;
  for (int i = 0; i <= radius; ++i) {
    weights[i] = std::exp(-0.5 * (i / sigma) * (i / sigma));
    sum += i == 0 ? weights[i] : 2 * weights[i];
  }
  for (double& w : weights) w /= sum;
  return weights;
}

// Smooths one period of a periodic sequence.
std::vector<PlanePoint> smooth_periodic(const std::vector<PlanePoint>& period, double sigma) {
  const std::vector<double> weights = gaussian(sigma);
  const int count = static_cast<int>(period.size());
  const int radius = static_cast<int>(weights.size()) - 1;
  std::vector<PlanePoint> padded(count + 2 * radius);
  for (int i = 0; i < count + 2 * radius; ++i) padded[i] = period[((i - radius) % count + count) % count];
  std::vector<PlanePoint> smooth(count);
  for (int i = 0; i < count; ++i) {
    const PlanePoint* here = padded.data() + i + radius;
    PlanePoint sum = weights[0] * *here;
    for (int j = 1; j <= radius; ++j) sum += weights[j] * (here[j] + here[-j]);
    smooth[i] = sum;
  }
  return smooth;
}

}  // namespace

std::vector<PlanePoint> resample(const Curve& curve, double spacing_mm) {
  const double length = length_mm(curve);
  const int least = curve.closed ? 3 : 1;
  const int steps = std::max(least, static_cast<int>(std::floor(length / spacing_mm + 0.5)));
  std::vector<PlanePoint> samples;
  for (const RulingFoot& foot : ruling_feet(curve, length / steps)) samples.push_back(foot.at);
  samples.back() = curve.closed ? curve.vertices.front() : curve.vertices.back();
  if (curve.closed) samples.pop_back();
  return samples;
}

std::vector<PlanePoint> smooth_along(const std::vector<PlanePoint>& samples, bool closed, double sigma) {
  if (closed) return smooth_periodic(samples, sigma);
  const int last = static_cast<int>(samples.size()) - 1;
  if (last < 1) return samples;
  const auto chord_at = [&](int i) -> PlanePoint {
    const double share = static_cast<double>(i) / last;
    return (1 - share) * samples.front() + share * samples.back();
  };
  std::vector<PlanePoint> departure(2 * last, PlanePoint::Zero());
  for (int i = 1; i < last; ++i) {
    departure[i] = samples[i] - chord_at(i);
    departure[2 * last - i] = -departure[i];
  }
  departure = smooth_periodic(departure, sigma);
  std::vector<PlanePoint> smooth(samples.size());
  for (int i = 0; i <= last; ++i) smooth[i] = chord_at(i) + departure[i];
  smooth.front() = samples.front();
  smooth.back() = samples.back();
  return smooth;
}

}  // namespace sonoband
