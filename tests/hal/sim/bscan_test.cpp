#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "hal/sim/bscan_simulator.h"
#include "hal/sim/screen.h"
#include "tests/support/support.h"

namespace sonoband::sim {
namespace {

using Eigen::Vector3d;

ScannerSettings small(ScannerSettings::Array array = ScannerSettings::Array::linear) {
  ScannerSettings s;
  s.array = array;
  s.width_px = 200;
  s.height_px = 240;
  s.face_width_mm = 36;
  s.depth_mm = 44;
  s.beams = 96;
  s.focus_mm = 22;
  s.noise_db = -300;
  s.depth_loss_db_mm = 0;
  s.decorations = false;
  return s;
}

std::shared_ptr<const Phantom> shared(Phantom p) {
  return std::make_shared<const Phantom>(std::move(p));
}

// The body around a bone at half depth, or just the body.
Phantom flesh(std::vector<Shape> shapes = {}) {
  return Anatomy({.echo_db = -30}, std::move(shapes), {-40, -10, -40}, {40, 70, 40});
}

Pixels paint(BscanSimulator& sim, const WorldFromImage& world_from_image, Stamp t = {}) {
  Pixels out(sim.settings().width_px, sim.settings().height_px);
  sim.paint(world_from_image, t, out.view().data, out.view().stride);
  return out;
}

WorldFromImage at_z(const ScannerSettings& s, double z) {
  WorldFromFace face;
  face.translation.z() = z;
  return face * face_from_image(s);
}

double mean(const Pixels& p, int x0, int x1, int y0, int y1) {
  double sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) sum += p.view()(x, y);
  }
  return sum / ((x1 - x0) * (y1 - y0));
}

// Pearson's, over the middle of the picture.
double correlation(const Pixels& a, const Pixels& b) {
  const double ma = mean(a, 20, 180, 20, 200);
  const double mb = mean(b, 20, 180, 20, 200);
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (int y = 20; y < 200; ++y) {
    for (int x = 20; x < 180; ++x) {
      const double da = a.view()(x, y) - ma;
      const double db = b.view()(x, y) - mb;
      ab += da * db;
      aa += da * da;
      bb += db * db;
    }
  }
  return ab / std::sqrt(aa * bb);
}

TEST(Bscan, ARampIsItsFormulaThroughTheWholeChainOfPoses) {
  std::mt19937_64 random(7);
  const ScannerSettings s = small();
  const Vector3d gradient(0.7, -1.1, 0.4);
  for (int trial = 0; trial < 5; ++trial) {
    WorldFromPhantom world_from_phantom{test::random_rotation(random), Vector3d(10, -20, 30)};
    const WorldFromImage world_from_image =
        WorldFromFace{test::random_rotation(random), Vector3d(15, 5, 25)} * face_from_image(s);
    BscanSimulator sim(shared(ramp(120, gradient)), world_from_phantom, s, 1);
    const Pixels p = paint(sim, world_from_image);
    for (int y = 0; y < s.height_px; y += 13) {
      for (int x = 0; x < s.width_px; x += 11) {
        const Vector3d world = world_from_image.linear * Vector3d(x, y, 0) + world_from_image.translation;
        const Vector3d phantom =
            world_from_phantom.rotation.transpose() * (world - world_from_phantom.translation);
        const double grey = std::clamp(120 + gradient.dot(phantom), 0.0, 255.0);
        EXPECT_NEAR(p.view()(x, y), grey, 0.5001);
      }
    }
  }
}

TEST(Bscan, WiresAppearAtTheirProjectionWithinHalfAPixel) {
  std::mt19937_64 random(8);
  const ScannerSettings s = small();
  for (int trial = 0; trial < 20; ++trial) {
    const WorldFromImage world_from_image =
        WorldFromFace{test::random_rotation(random), Vector3d(150, -40, 60)} * face_from_image(s);
    std::uniform_real_distribution<double> u(0, 1);
    const Vector3d px(40 + 120 * u(random), 40 + 150 * u(random), 0);
    const Vector3d through = world_from_image.linear * px + world_from_image.translation;
    // A wire that pierces the picture at px, within 60 degrees of square.
    const Vector3d normal = world_from_image.linear.col(0).cross(world_from_image.linear.col(1)).normalized();
    const Vector3d lean = world_from_image.linear.col(0).normalized() * (2 * u(random) - 1);
    const Vector3d direction = (normal + lean).normalized();
    BscanSimulator sim(shared(wires({{through + 7 * direction, direction}})), {}, s, 1);
    const Pixels p = paint(sim, world_from_image);
    double weight = 0;
    Vector3d centroid = Vector3d::Zero();
    for (int y = 0; y < s.height_px; ++y) {
      for (int x = 0; x < s.width_px; ++x) {
        const double w = p.view()(x, y) - 20;
        weight += w;
        centroid += w * Vector3d(x, y, 0);
      }
    }
    EXPECT_LT((centroid / weight - px).norm(), 0.5);
  }
}

TEST(Bscan, AStillProbeSeesTheSameSpeckle) {
  const ScannerSettings s = small();
  BscanSimulator sim(shared(flesh()), {}, s, 1);
  const Pixels a = paint(sim, at_z(s, 0), Stamp(std::chrono::seconds(1)));
  const Pixels b = paint(sim, at_z(s, 0), Stamp(std::chrono::seconds(2)));
  EXPECT_TRUE(std::ranges::equal(std::span(a.view().data, 200 * 240), std::span(b.view().data, 200 * 240)));
  // It is speckle, not a constant: a logarithm of a fading signal deviates by several dB (4.25 levels each).
  EXPECT_LT(correlation(a, paint(sim, at_z(s, 10))), 0.2);
}

TEST(Bscan, ReceiverNoiseTellsAStillProbeFromAFrozenPicture) {
  ScannerSettings s = small();
  s.noise_db = ScannerSettings{}.noise_db;
  BscanSimulator sim(shared(flesh()), {}, s, 1);
  const Pixels a = paint(sim, at_z(s, 0), Stamp(std::chrono::seconds(1)));
  const Pixels b = paint(sim, at_z(s, 0), Stamp(std::chrono::seconds(2)));
  double difference = 0;
  for (int i = 0; i < 200 * 240; ++i) difference += std::abs(a.view().data[i] - b.view().data[i]);
  EXPECT_GT(difference / (200 * 240), 0.1);
  EXPECT_GT(correlation(a, b), 0.95);
}

// The beam is 0.55 mm (sigma) thick at its focus and the scatterers' grain 0.35 mm.
TEST(Bscan, SpeckleDecorrelatesWithElevation) {
  const ScannerSettings s = small();
  BscanSimulator sim(shared(flesh()), {}, s, 1);
  const Pixels still = paint(sim, at_z(s, 0));
  const double near = correlation(still, paint(sim, at_z(s, 0.2)));
  const double half = correlation(still, paint(sim, at_z(s, 0.6)));
  const double patches = correlation(still, paint(sim, at_z(s, 3)));  // uneven tissue is left
  const double far = correlation(still, paint(sim, at_z(s, 25)));
  EXPECT_GT(near, 0.75);
  EXPECT_LT(half, 0.65);
  EXPECT_GT(half, 0.1);
  EXPECT_LT(patches, 0.3);
  EXPECT_LT(std::abs(far), 0.12);
}

TEST(Bscan, SameSeedSameBytesAnotherSeedOthers) {
  const ScannerSettings s = small(ScannerSettings::Array::convex);
  const auto phantom = shared(flesh());
  BscanSimulator a(phantom, {}, s, 1);
  BscanSimulator b(phantom, {}, s, 1);
  BscanSimulator c(phantom, {}, s, 2);
  const Pixels pa = paint(a, at_z(s, 3));
  paint(b, at_z(s, 20));  // history must not matter
  const Pixels pb = paint(b, at_z(s, 3));
  const Pixels pc = paint(c, at_z(s, 3));
  EXPECT_TRUE(std::ranges::equal(std::span(pa.view().data, 200 * 240), std::span(pb.view().data, 200 * 240)));
  EXPECT_FALSE(
      std::ranges::equal(std::span(pa.view().data, 200 * 240), std::span(pc.view().data, 200 * 240)));
}

TEST(Bscan, ABoneShinesAndShadowsWhatIsBehind) {
  const ScannerSettings s = small();
  // 3 mm thick at 4 dB/mm: 12 dB less behind it, 4.25 grey levels a dB.
  const Material bone{.echo_db = 3, .loss_db_mm = 4, .specular = 0.5F, .bone = true};
  BscanSimulator sim(shared(flesh({capsule({0, 20, -30}, {0, 20, 30}, 1.5F, bone),
                                   ellipsoid({0, 20, 0}, {8, 1.5F, 30}, bone)})),
                     {}, s, 1);
  const Pixels p = paint(sim, at_z(s, 0));
  const int row = static_cast<int>(s.face_row_px + 20 / s.pixel_mm);
  const double behind = mean(p, 80, 120, row + 20, row + 60);
  const double beside = mean(p, 15, 35, row + 20, row + 60);
  EXPECT_GT(mean(p, 90, 110, row - 5, row), 235);
  EXPECT_NEAR(beside - behind, 12 * 4.25, 8);
  EXPECT_NEAR(beside, 255 * (1 - 30.0 / 60) - 4, 8);
}

TEST(Bscan, EchoesFadeWithDepthAsTold) {
  ScannerSettings s = small();
  s.depth_loss_db_mm = 0.4;
  BscanSimulator sim(shared(flesh()), {}, s, 1);
  const Pixels p = paint(sim, at_z(s, 0));
  const double drop = mean(p, 20, 180, 40, 60) - mean(p, 20, 180, 140, 160);
  EXPECT_NEAR(drop, 100 * s.pixel_mm * 0.4 * 4.25, 4);
}

TEST(Bscan, TheBeamHasAThickness) {
  const ScannerSettings s = small();
  // A reflector 1 mm off the plane is seen, 4 mm off not.
  const auto seen = [&](float z) {
    BscanSimulator sim(shared(flesh({capsule({-5, 22, z}, {5, 22, z}, 0.6F, {.echo_db = 5, .bone = true})})),
                       {}, s, 1);
    const Pixels p = paint(sim, at_z(s, 0));
    return mean(p, 90, 110, 118, 123);
  };
  EXPECT_GT(seen(1), 180);
  EXPECT_LT(seen(4), 145);
}

TEST(Bscan, OutsideTheMaskIsBlack) {
  for (const auto array : {ScannerSettings::Array::linear, ScannerSettings::Array::convex}) {
    const ScannerSettings s = small(array);
    BscanSimulator sim(shared(flesh()), {}, s, 1);
    const Pixels p = paint(sim, at_z(s, 0));
    const Pixels mask = body_mask(s);
    int inside = 0;
    for (int y = 0; y < s.height_px; ++y) {
      for (int x = 0; x < s.width_px; ++x) {
        if (mask.view()(x, y) != 0) ++inside;
        if (mask.view()(x, y) == 0) {
          EXPECT_EQ(p.view()(x, y), 0);
        }
      }
    }
    EXPECT_GT(inside, 15000);
  }
}

TEST(Bscan, FlowIsRedTowardsAndBlueAwayWithinTheBoxOnly) {
  ScannerSettings s = small();
  s.format = PixelFormat::rgb24;
  s.colour = ColourBox{.x = 30, .y = 30, .width = 140, .height = 120};
  std::vector<Shape> tubes{capsule({-8, 15, -30}, {-8, 15, 30}, 3, {.echo_db = -56}),
                           capsule({8, 15, -30}, {8, 15, 30}, 3, {.echo_db = -56}),
                           capsule({0, 38, -30}, {0, 38, 30}, 3, {.echo_db = -56})};
  tubes[0].flow = {.peak_mm_s = 300};
  tubes[1].flow = {.peak_mm_s = -200};
  tubes[2].flow = {.peak_mm_s = 300};
  BscanSimulator sim(shared(flesh(tubes)), {}, s, 1);
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(3 * s.width_px * s.height_px));
  sim.paint(at_z(s, 0), {}, rgb.data(), 3 * s.width_px);
  const auto pixel = [&](double x_mm, double y_mm) {
    const auto x = static_cast<int>(std::lround((s.width_px - 1) / 2.0 + x_mm / s.pixel_mm));
    const auto y = static_cast<int>(std::lround(s.face_row_px + y_mm / s.pixel_mm));
    return rgb.data() + std::ptrdiff_t{3} * (std::ptrdiff_t{y} * s.width_px + x);
  };
  const doppler::ColourBar bar = doppler::red_blue_bar();
  const doppler::Rgb red = flow_colour(bar, static_cast<int>(std::lround(63 * 300 / 400.0)));
  const doppler::Rgb blue = flow_colour(bar, -static_cast<int>(std::lround(63 * 200 / 400.0)));
  const auto near = [](const std::uint8_t* seen, doppler::Rgb c) {
    return std::abs(seen[0] - c.r) + std::abs(seen[1] - c.g) + std::abs(seen[2] - c.b) < 20;
  };
  EXPECT_TRUE(near(pixel(-8, 15), red));
  EXPECT_TRUE(near(pixel(8, 15), blue));
  const std::uint8_t* below = pixel(0, 38);  // outside the box: grey
  EXPECT_EQ(below[0], below[2]);
  const std::uint8_t* corner = rgb.data() + std::ptrdiff_t{3} * (std::ptrdiff_t{29} * s.width_px + 29);
  EXPECT_EQ(int{corner[0]} + corner[1] + corner[2], 3 * 255);
}

}  // namespace
}  // namespace sonoband::sim
