// Frames denser than the output's pixels, left out by the rule of core/reslice/chain.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/image/doppler.h"
#include "core/reslice/band.h"
#include "core/reslice/chain.h"
#include "core/reslice/thinning.h"
#include "tests/core/reslice/compare.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr double pixel_mm = 0.2;
constexpr double half_pixel_mm = (0.5 + 1.0 / 256) * pixel_mm;  // as near as the rule counts it

// Frames of noise, `spacing_mm` apart but for a tenth of it, with a hand's wobble: wherever a value comes
// from, it tells.
void add_frames(test::TestSweep& sweep, int count, double spacing_mm) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  for (int i = 0; i < count; ++i) {
    const double z = spacing_mm * (i + jitter(random));
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.03 * std::sin(0.5 * z), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.03 * std::sin(0.7 * z), Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    sweep.add(120, 70, test::image_pose(axes, {0, 0, z}, pixel_mm),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
}

// A thin plane across the frames, turned in itself: well inside their pictures about the middle (12, 7, 5)
// mm.
ReslicePlane plane_across(double turn_deg, const Eigen::Vector3d& middle = {12, 7, 5}) {
  const Eigen::Matrix3d axes = (Eigen::AngleAxisd(M_PI / 2 + 0.2, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  return *make_plane(middle - 4.0 * axes.col(0) - 4.0 * axes.col(1), axes.col(0), axes.col(1), 41, 41,
                     pixel_mm);
}

RenderSettings thin_settings(Interpolation interpolation) {
  RenderSettings settings;
  settings.band = {0, pixel_mm};
  settings.interpolation = interpolation;
  settings.thin_dense_frames = true;
  return settings;
}

Eigen::Vector3d foot(const TrackedFrame& f, const Eigen::Vector3d& p) {
  return (f.image_from_world * Point<frame::World>{p}).v;
}

// The definition's frame at p: the one with the smallest distance but for ties.
bool is_nearest(const test::TestSweep& sweep, const TrackedFrame& f, const Eigen::Vector3d& p) {
  const double z = std::abs(foot(f, p).z());
  return std::all_of(sweep.view().frames.begin(), sweep.view().frames.end(),
                     [&](const TrackedFrame* other) { return std::abs(foot(*other, p).z()) >= z - 1e-4; });
}

bool contains(const TrackedFrame& f, const Eigen::Vector3d& at) {
  return at.x() >= -0.5 && at.y() >= -0.5 && at.x() < f.bscan.pixels.width - 0.5 &&
         at.y() < f.bscan.pixels.height - 0.5;
}

// Of the frames about p some hold its foot and some do not, or they are all on one side of it.
bool at_an_edge(const test::TestSweep& sweep, const Eigen::Vector3d& p) {
  bool some_hold = false, some_do_not = false, above = false, below = false;
  for (const TrackedFrame* f : sweep.view().frames) {
    const Eigen::Vector3d at = foot(*f, p);
    if (std::abs(at.z()) > 3 * pixel_mm) continue;
    (contains(*f, at) ? some_hold : some_do_not) = true;
    (at.z() > 0 ? above : below) = true;
  }
  return (some_hold && some_do_not) || !above || !below;
}

std::uint8_t nearest_pixel(const TrackedFrame& f, const Eigen::Vector3d& at) {
  return f.bscan.pixels(static_cast<int>(std::floor(at.x() + 0.5)),
                        static_cast<int>(std::floor(at.y() + 0.5)));
}

double bilinear(const TrackedFrame& f, const Eigen::Vector3d& at) {
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  const double u = at.x() - x, v = at.y() - y;
  const auto& p = f.bscan.pixels;
  return (1 - v) * ((1 - u) * p(x, y) + u * p(x + 1, y)) + v * ((1 - u) * p(x, y + 1) + u * p(x + 1, y + 1));
}

// How far from a sample along a frame's normal its own pixel reaches: half a pixel along each of the plane's
// axes.
double reach_mm(const ReslicePlane& plane, const Eigen::Vector3d& normal) {
  double reach = 1e9;
  for (const Eigen::Vector3d& axis : {plane.right.v, plane.down.v, plane.normal().v})
    reach = std::min(reach, half_pixel_mm / std::max(std::abs(axis.dot(normal)), 1e-9));
  return reach;
}

// The definition gives `value` at a point of the pixel of which p is the middle.
bool found_near(const test::TestSweep& sweep, const ReslicePlane& plane, const Eigen::Vector3d& p,
                std::uint8_t value) {
  for (const TrackedFrame* f : sweep.view().frames) {
    const Eigen::Vector3d at = foot(*f, p);
    if (std::abs(at.z()) > 3 * pixel_mm || nearest_pixel(*f, at) != value) continue;
    // Towards the frame, where it is nearest if anywhere.
    const Eigen::Vector3d normal = f->world_from_image.linear.col(2).normalized();
    const double reach = reach_mm(plane, normal) + 1e-6;
    if (is_nearest(sweep, *f, p + std::clamp(-at.z(), -reach, reach) * normal)) return true;
  }
  return false;
}

// `value` is a frame's bilinear one, and the frame's plane, where that is the definition's, runs through the
// pixel of which p is the middle; or it is the end frame's beyond it.
bool on_a_plane_near(const test::TestSweep& sweep, const ReslicePlane& plane, const Eigen::Vector3d& p,
                     std::uint8_t value) {
  for (const TrackedFrame* f : sweep.view().frames) {
    const Eigen::Vector3d at = foot(*f, p);
    const bool beyond =
        (f == sweep.view().frames.front() && at.z() < 0) || (f == sweep.view().frames.back() && at.z() > 0);
    const double reach = reach_mm(plane, f->world_from_image.linear.col(2).normalized()) + 1e-6;
    if (!beyond && std::abs(at.z()) > reach) continue;
    if (std::abs(bilinear(*f, at) - value) <= 1.5) return true;
  }
  return false;
}

class DenseFrames : public testing::TestWithParam<double> {};

// Few of 256 values are right by chance: about as many as frames within reach.
TEST_P(DenseFrames, KeepsTheDefinitionWithinHalfAPixel) {
  const double spacing_mm = GetParam();
  const int frames = static_cast<int>(10 / spacing_mm);
  test::TestSweep sweep;
  add_frames(sweep, frames, spacing_mm);
  Serial serial;
  for (const double turn_deg : {0.0, 30.0, 90.0}) {
    const ReslicePlane plane = plane_across(turn_deg);
    for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
      RenderSettings settings = thin_settings(interpolation);
      const BandImage image = render_planar(sweep.view(), plane, settings, serial);
      settings.thin_dense_frames = false;
      const BandImage exact = render_planar(sweep.view(), plane, settings, serial);
      for (int y = 0; y < plane.height; y += 2) {
        for (int x = 0; x < plane.width; x += 2) {
          const Eigen::Vector3d p =
              (plane.origin + (x * pixel_mm) * plane.right + (y * pixel_mm) * plane.down).v;
          ASSERT_EQ(image.coverage.view()(x, y), exact.coverage.view()(x, y));
          if (image.coverage.view()(x, y) == 0) continue;
          const std::uint8_t value = image.pixels.view()(x, y);
          ASSERT_TRUE(interpolation == Interpolation::nearest ? found_near(sweep, plane, p, value)
                                                              : on_a_plane_near(sweep, plane, p, value))
              << x << "," << y << " turned by " << turn_deg << ", linear "
              << (interpolation == Interpolation::linear);
        }
      }
    }
  }
}

// Tiles and patches in which pictures end, where frames are no chain.
TEST_P(DenseFrames, KeepTheDefinitionWithinHalfAPixelBesideTheirEdges) {
  const double spacing_mm = GetParam();
  test::TestSweep sweep;
  add_frames(sweep, static_cast<int>(10 / spacing_mm), spacing_mm);
  Serial serial;
  int compared = 0, otherwise_covered = 0;
  for (const double turn_deg : {0.0, 35.0}) {
    const ReslicePlane plane = plane_across(turn_deg, {22, 7, 5});
    RenderSettings settings = thin_settings(Interpolation::nearest);
    const BandImage image = render_planar(sweep.view(), plane, settings, serial);
    // Tiles where pictures end are thinned by what they see, as others are: to a pixel and a gap, but for the
    // hand.
    const double to_next_mm = pixel_mm + spacing_mm;
    EXPECT_GT(image.frames_left_out, 0.84 * (10 / spacing_mm - 10 / to_next_mm));
    settings.thin_dense_frames = false;
    const BandImage exact = render_planar(sweep.view(), plane, settings, serial);
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x) {
        otherwise_covered += image.coverage.view()(x, y) != exact.coverage.view()(x, y) ? 1 : 0;
        const Eigen::Vector3d p =
            (plane.origin + (x * pixel_mm) * plane.right + (y * pixel_mm) * plane.down).v;
        if (at_an_edge(sweep, p)) continue;
        ASSERT_EQ(image.coverage.view()(x, y), exact.coverage.view()(x, y));
        if (image.coverage.view()(x, y) == 0) continue;
        ++compared;
        ASSERT_TRUE(found_near(sweep, plane, p, image.pixels.view()(x, y)))
            << x << "," << y << " turned by " << turn_deg;
      }
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_LE(otherwise_covered, 3);  // ties at the edges
}

INSTANTIATE_TEST_SUITE_P(Spacings, DenseFrames, testing::Values(0.1, 0.07, 0.025));

TEST(Thinning, LeavesOutWhatTheRuleLets) {
  Serial serial;
  const ReslicePlane plane = plane_across(0);
  const auto left_out = [&](double spacing_mm, Interpolation interpolation) {
    test::TestSweep sweep;
    add_frames(sweep, static_cast<int>(10 / spacing_mm), spacing_mm);
    return render_planar(sweep.view(), plane, thin_settings(interpolation), serial).frames_left_out;
  };
  // 100 frames half a pixel apart: every other one; 400 an eighth of a pixel apart stay 8 or so apart.
  EXPECT_GE(left_out(0.1, Interpolation::nearest), 45);
  EXPECT_LE(left_out(0.1, Interpolation::nearest), 55);
  EXPECT_GE(left_out(0.025, Interpolation::nearest), 320);
  EXPECT_GE(left_out(0.025, Interpolation::linear), 320);
  EXPECT_EQ(left_out(0.3, Interpolation::nearest), 0);
  EXPECT_EQ(left_out(0.3, Interpolation::linear), 0);
}

// Parallel frames, two gaps of which are `gaps` pixels.
test::TestSweep steady_frames(double gaps, int count) {
  test::TestSweep sweep;
  for (int i = 0; i < count; ++i) {
    sweep.add(120, 70,
              test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, i * gaps * pixel_mm / 2}, pixel_mm),
              [&](int, int, const Eigen::Vector3d&) { return std::uint8_t{9}; });
  }
  return sweep;
}

// Half a pixel is kept to 1/256 of one: two gaps of 1 1/128 pixels are a pixel to chains and to whole sweeps.
TEST(Thinning, TakesAPixelAndAHundredTwentyEighthForOne) {
  Serial serial;
  const ReslicePlane along_normals = *make_plane(Eigen::Vector3d(8, 7, 1), Eigen::Vector3d::UnitX(),
                                                 Eigen::Vector3d::UnitZ(), 41, 41, pixel_mm);
  for (const bool inside : {true, false}) {
    const test::TestSweep sweep = steady_frames(1 + 1.0 / 128 + (inside ? -1e-3 : 1e-3), 101);
    // Nearest takes every third frame or every second, linear every second or all.
    EXPECT_EQ(thinned_for_nearest(sweep.view(), pixel_mm).size(), inside ? 35U : 51U);
    EXPECT_EQ(thinned(sweep.view(), pixel_mm).size(), inside ? 51U : 101U);
    const auto left_out = [&](Interpolation interpolation) {
      return render_planar(sweep.view(), along_normals, thin_settings(interpolation), serial).frames_left_out;
    };
    EXPECT_NEAR(left_out(Interpolation::nearest), inside ? 67 : 50, 2);
    EXPECT_NEAR(left_out(Interpolation::linear), inside ? 50 : 0, 2);
  }
}

// 0.1 mm apart and a pixel of 0.25 mm: a frame is at most two gaps from the one before the next that stays.
TEST(Thinning, ForNearestCountsFromTheFrameBeforeTheNext) {
  test::TestSweep sweep;
  const auto add = [&](double z, double tilt) {
    const Eigen::Matrix3d axes = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    sweep.add(20, 10, test::image_pose(axes, {0, 0, z}, 0.25),
              [](int, int, const Eigen::Vector3d&) { return std::uint8_t{9}; });
  };
  for (int i = 0; i <= 40; ++i) add(0.1 * i, 0);
  std::vector<const TrackedFrame*> kept = thinned_for_nearest(sweep.view(), 0.25);
  ASSERT_EQ(kept.size(), 15U);
  for (int i = 0; i < 14; ++i) EXPECT_EQ(kept[i], sweep.view().frames[3 * i]);
  EXPECT_EQ(kept.back(), sweep.view().frames.back());
  // The way back: the frame at which the probe turns stays.
  for (int i = 0; i < 5; ++i) add(3.95 - 0.1 * i, 0);
  kept = thinned_for_nearest(sweep.view(), 0.25);
  const auto stays = [&](int i) {
    return std::find(kept.begin(), kept.end(), sweep.view().frames[i]) != kept.end();
  };
  EXPECT_TRUE(stays(40));
  EXPECT_TRUE(stays(45));
  EXPECT_LT(kept.size(), 19U);
  // Frames that cross those beside them all stay.
  for (int i = 1; i <= 6; ++i) add(3.55 - 0.01 * i, i % 2 == 0 ? 0.02 : -0.02);
  kept = thinned_for_nearest(sweep.view(), 0.25);
  for (int i = 46; i <= 51; ++i) EXPECT_TRUE(stays(i)) << i;
}

// A line that runs between the plane's axes is longer in the pixel than one along an axis.
TEST(Thinning, CountsHalfAPixelAlongEachOfTheAxes) {
  OutputPixel pixel{0.25};
  const Eigen::Vector3d between = Eigen::Vector3d(1, -1, 1).normalized();
  EXPECT_DOUBLE_EQ(pixel.along(between), thinning_pixel * 0.25);  // without axes
  pixel.axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix().transpose();
  EXPECT_NEAR(pixel.along(pixel.axes.row(1)), thinning_pixel * 0.25, 1e-12);
  EXPECT_NEAR(pixel.along(pixel.axes.transpose() * between), thinning_pixel * 0.25 * std::sqrt(3.0), 1e-12);
  const Eigen::Vector3d in_plane = pixel.axes.transpose() * Eigen::Vector3d(1, 1, 0).normalized();
  EXPECT_NEAR(pixel.along(in_plane), thinning_pixel * 0.25 * std::sqrt(2.0), 1e-12);
}

// What no frame went from and is farther apart than a pixel is the definition's, bit for bit.
TEST(Thinning, BlendsFramesFartherApartThanAPixel) {
  test::TestSweep sweep;
  add_frames(sweep, 40, 0.3);
  Serial serial;
  for (const double turn_deg : {0.0, 30.0}) {
    const ReslicePlane plane = plane_across(turn_deg);
    RenderSettings settings = thin_settings(Interpolation::linear);
    const BandImage image = render_planar(sweep.view(), plane, settings, serial);
    settings.thin_dense_frames = false;
    EXPECT_TRUE(test::same_bits(image, render_planar(sweep.view(), plane, settings, serial))) << turn_deg;
  }
}

// Frames half a pixel apart of the same picture: thinned or not, the same bits, whatever the taps.
TEST(Thinning, TakesLinearTapsAsTheMaskAndColoursSay) {
  Serial serial;
  for (const PixelKind kind : {PixelKind::grey, PixelKind::doppler}) {
    test::TestSweep sweep;
    Pixels mask(120, 70);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 120; ++x) mask.view()(x, y) = x % 7 == 0 && y % 5 == 0 ? 0 : 1;
    for (int i = 0; i < 101; ++i) {
      sweep.add(
          120, 70, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, i * 0.1}, pixel_mm),
          [&](int x, int y, const Eigen::Vector3d&) {
            if (kind == PixelKind::doppler) return doppler::colour_key(30, (x / 2 + y) % 2 == 0);
            // Masked pixels must not shine through.
            return static_cast<std::uint8_t>(mask.view()(x, y) == 0 ? 255 : 9);
          },
          kind);
    }
    if (kind == PixelKind::grey) sweep.set_mask(std::move(mask));
    RenderSettings settings = thin_settings(Interpolation::linear);
    const ReslicePlane plane = plane_across(25);
    const BandImage image = render_planar(sweep.view(), plane, settings, serial);
    EXPECT_GT(image.frames_left_out, 0);
    settings.thin_dense_frames = false;
    const BandImage exact = render_planar(sweep.view(), plane, settings, serial);
    EXPECT_TRUE(test::same_bits(image, exact)) << static_cast<int>(kind);
  }
}

// A bundle that is the plane's, and any number of threads, leave out the same frames.
TEST(Thinning, GivesTheSameBitsToBundlesOfAPlane) {
  test::TestSweep sweep;
  add_frames(sweep, 200, 0.05);
  const ReslicePlane plane = plane_across(20);
  const RenderSettings settings = thin_settings(Interpolation::nearest);
  Serial serial;
  const BandImage of_plane = render_planar(sweep.view(), plane, settings, serial);
  const BandImage of_lines = render_lines(sweep.view(), plane_lines(plane, settings.band), settings, serial);
  EXPECT_TRUE(test::same_bits(of_plane, of_lines));
  EXPECT_EQ(of_plane.frames_left_out, of_lines.frames_left_out);
  EXPECT_GT(of_plane.frames_left_out, 100);
}

}  // namespace
}  // namespace sonoband
