#include "tests/core/reslice/random_geometry.h"

#include <cmath>

#include "tests/support/support.h"

namespace sonoband::test {

Pixels sector_mask(int width, int height) {
  Pixels mask(width, height);
  const double apex_x = (width - 1) / 2.0, apex_y = -0.25 * height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double dx = x - apex_x, dy = y - apex_y, r = std::hypot(dx, dy);
      const bool inside = r > 0.35 * height && r < 1.2 * height && std::abs(dx) < 0.7 * dy;
      mask.view()(x, y) = inside ? 255 : 0;
    }
  }
  return mask;
}

RandomScene random_scene(unsigned seed) {
  std::mt19937_64 random(seed);
  const auto real = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto integer = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(random); };
  RandomScene scene;
  const double pixel = real(0.15, 0.4);
  const int width = integer(20, 97), height = integer(20, 91);
  const PixelKind kind = integer(0, 2) == 0 ? PixelKind::doppler : PixelKind::grey;
  const bool masked = integer(0, 1) == 0, odd_sizes = !masked && integer(0, 1) == 0;
  const Eigen::Matrix3d room = random_rotation(random);
  const int sweeps = integer(1, 3);
  const double wobble = integer(0, 2) == 0 ? 0 : real(0, 6) * M_PI / 180;
  for (int s = 0; s < sweeps; ++s) {
    const int frames = integer(1, 24);
    const double spacing = real(0.05, 0.8) * (integer(0, 1) == 0 ? -1 : 1);
    const double fan = integer(0, 3) == 0 ? real(-3, 3) * M_PI / 180 : 0;
    const Eigen::Vector3d from(real(-4, 4), real(-4, 4), real(-5, 5));
    const bool turned = integer(0, 3) == 0;
    for (int i = 0; i < frames; ++i) {
      Eigen::Matrix3d axes =
          (Eigen::AngleAxisd(fan * i, Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(wobble * real(-1, 1), Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(wobble * real(-1, 1), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(wobble * real(-1, 1) + (turned ? M_PI : 0), Eigen::Vector3d::UnitZ()))
              .toRotationMatrix();
      if (turned) axes = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix() * axes;
      const int w = odd_sizes ? integer(1, width) : width, h = odd_sizes ? integer(1, height) : height;
      const Eigen::Vector3d corner = from + Eigen::Vector3d(0, 0, spacing * i) -
                                     pixel * ((w - 1) / 2.0 * axes.col(0) + (h - 1) / 2.0 * axes.col(1));
      scene.sweep.add(
          w, h, image_pose(room * axes, room * corner, pixel),
          [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); }, kind, s);
    }
  }
  if (masked) scene.sweep.set_mask(sector_mask(width, height));
  // A third of the planes are along the frames' axes, where ties and grazing are at home.
  const Eigen::Matrix3d axes =
      integer(0, 2) == 0
          ? Eigen::Matrix3d(room * Eigen::AngleAxisd(M_PI / 2 * integer(0, 3), Eigen::Vector3d::UnitX()) *
                            Eigen::AngleAxisd(M_PI / 2 * integer(0, 3), Eigen::Vector3d::UnitY()))
          : random_rotation(random);
  const int out_width = integer(1, 90), out_height = integer(1, 40);
  const double out_pixel = integer(0, 1) == 0 ? pixel : real(0.1, 0.5);
  const Eigen::Vector3d middle = room * Eigen::Vector3d(real(-3, 3), real(-3, 3), real(-3, 3));
  scene.plane = *make_plane(
      middle - out_pixel * ((out_width - 1) / 2.0 * axes.col(0) + (out_height - 1) / 2.0 * axes.col(1)),
      axes.col(0), axes.col(1), out_width, out_height, out_pixel);
  scene.settings.band = {integer(0, 2) == 0 ? 0 : real(0, 3), out_pixel};
  scene.settings.compounding = static_cast<Compounding>(integer(0, 2));
  if (integer(0, 1) == 0) scene.settings.gap.mm = real(0.05, 2);
  return scene;
}

}  // namespace sonoband::test
