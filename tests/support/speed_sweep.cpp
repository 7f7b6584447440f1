#include "tests/support/speed_sweep.h"

#include <cmath>

#include "tests/support/support.h"

namespace sonoband::test {
namespace {

const Eigen::Vector3d middle_mm(0, 48, 50);

Eigen::Matrix3d turn(double x_deg, double y_deg, double z_deg) {
  const double rad = M_PI / 180;
  return (Eigen::AngleAxisd(z_deg * rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(y_deg * rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x_deg * rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

ReslicePlane centred(const Eigen::Vector3d& right, const Eigen::Vector3d& down, int width, int height,
                     double pixel_mm) {
  const Eigen::Vector3d origin =
      middle_mm - pixel_mm * ((width - 1) / 2.0 * right + (height - 1) / 2.0 * down);
  return *make_plane(origin, right, down, width, height, pixel_mm);
}

// One tile of Rayleigh-like speckle, shifted from frame to frame.
class Speckle {
 public:
  explicit Speckle(std::mt19937_64& random) : tile_(static_cast<std::size_t>(size) * size) {
    std::normal_distribution<float> gauss(0, 0.5F);
    for (float& s : tile_) s = std::hypot(gauss(random), gauss(random));
  }
  float at(unsigned x, unsigned y) const { return tile_[(y % size) * size + x % size]; }

 private:
  static constexpr unsigned size = 512;
  std::vector<float> tile_;
};

}  // namespace

TestSweep speed_sweep(const SpeedSweepOptions& o) {
  TestSweep sweep;
  std::mt19937_64 random(7);
  const Speckle speckle(random);
  std::uniform_real_distribution<double> jitter(-1, 1);
  const double spacing = o.frames > 1 ? o.length_mm / (o.frames - 1) : 0;
  for (int i = 0; i < o.frames; ++i) {
    const double z = spacing * i, s = z / 100, two_pi = 2 * M_PI;
    Eigen::Vector3d angles(std::sin(two_pi * (1.3 * s + 0.37)), std::sin(two_pi * (1.7 * s + 0.1)),
                           std::sin(two_pi * (2.1 * s + 0.6)));
    angles *= 3;
    if (s > 0.9) angles.x() += (s - 0.9) * 10 * 8;
    Eigen::Vector3d t(0.5 * std::sin(two_pi * 3.1 * s), 0.5 * std::sin(two_pi * (2.7 * s + 0.2)),
                      z + 0.5 * std::sin(two_pi * (1.9 * s + 0.7)) + 0.1 * spacing * jitter(random));
    if (o.crossing) {
      for (int k = 0; k < 3; ++k) angles[k] += 3 * jitter(random);
      t.z() += 0.5 * jitter(random);
    }
    const Eigen::Matrix3d axes = turn(angles.x(), angles.y(), angles.z());
    const unsigned shift_x = static_cast<unsigned>(random()), shift_y = static_cast<unsigned>(random());
    sweep.add(o.width, o.height,
              image_pose(axes, t - (o.width - 1) / 2.0 * o.pixel_mm * axes.col(0), o.pixel_mm),
              [&](int x, int y, const Eigen::Vector3d& p) {
                // Slow tissue and one bright ball of 30 mm in the middle.
                const float tissue = 0.5F + 0.2F * std::sin(static_cast<float>(0.1 * p.x())) +
                                     0.2F * std::cos(static_cast<float>(0.13 * p.y() + 0.15 * p.z()));
                const float ball = (p - middle_mm).squaredNorm() < 900 ? 70.0F : 0.0F;
                const float grey =
                    (140 * tissue + ball) * (0.35F + 0.9F * speckle.at(x + shift_x % 512, y + shift_y % 512));
                return static_cast<std::uint8_t>(std::clamp(grey, 1.0F, 255.0F));
              });
  }
  return sweep;
}

std::vector<NamedPlane> speed_planes(int width, int height, double pixel_mm) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const auto plane = [&](const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
    return centred(right, down, width, height, pixel_mm);
  };
  const Eigen::Matrix3d oblique = turn(35, 40, 25), tilt = turn(60, 0, 0);
  return {{"c", plane(x, z)},
          {"longitudinal", plane(z, y)},
          {"parallel", plane(x, y)},
          {"oblique", plane(oblique.col(0), oblique.col(1))},
          {"tilt60", plane(tilt.col(0), tilt.col(1))},
          {"c45", plane(x + z, z - x)}};
}

std::vector<ReslicePlane> random_planes(int count, unsigned seed, int width, int height, double pixel_mm) {
  std::mt19937_64 random(seed);
  std::vector<ReslicePlane> planes;
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d r = random_rotation(random);
    planes.push_back(centred(r.col(0), r.col(1), width, height, pixel_mm));
  }
  return planes;
}

}  // namespace sonoband::test
