// Pictures kept turned: they hold the pixels, and bands painted from them have the same bits.
#include "core/reslice/turned_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/reslice/frame_table.h"
#include "core/reslice/patch.h"
#include "core/reslice/prepared_sweep.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr std::size_t any = ~std::size_t{0};

// B-scans of noise 0.4 mm apart that a hand has tilted a little.
test::TestSweep noisy_sweep(int width, int height, int frames) {
  test::TestSweep sweep;
  std::mt19937_64 random(5);
  for (int i = 0; i < frames; ++i) {
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.02 * std::sin(0.16 * i), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.03 * std::sin(0.11 * i), Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    sweep.add(width, height, test::image_pose(axes, {0, 0, 0.4 * i}, 0.2),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
  return sweep;
}

// Along the probe's motion and down the pictures: its lines run down pixel columns.
ReslicePlane longitudinal_plane(double x_mm) {
  return *make_plane({x_mm, 2, 2}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 110, 90, 0.2);
}

RenderSettings thick(Interpolation interpolation) {
  RenderSettings settings;
  settings.band = {4, 0.2};
  settings.interpolation = interpolation;
  return settings;
}

FrameTable entered(const TurnedFrames& turned, const test::TestSweep& sweep) {
  FrameTable table = make_frame_table(sweep.view(), {});
  turned.enter(table);
  return table;
}

TEST(KeptTurned, HoldPixelColumnsAsRows) {
  Serial serial;
  for (const int width : {16, 33, 150}) {
    for (const int height : {1, 31, 120}) {
      const test::TestSweep sweep = noisy_sweep(width, height, 3);
      TurnedFrames turned;
      turned.extend(sweep.view(), any, serial);
      for (const FrameEntry& frame : entered(turned, sweep).frames) {
        ASSERT_NE(frame.turned, nullptr);
        ASSERT_GE(frame.turned_stride, height);
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x)
            ASSERT_EQ(frame.turned[x * frame.turned_stride + y], frame.pixels[y * frame.stride + x]);
      }
    }
  }
}

TEST(KeptTurned, GiveTheBitsOfTheirPicturesAndSpareTurningParts) {
  const test::TestSweep sweep = noisy_sweep(150, 120, 60);
  Serial serial;
  for (const Interpolation interpolation : {Interpolation::nearest, Interpolation::linear}) {
    // The second one runs beyond the pictures' edges.
    for (const double x_mm : {14.0, 28.5}) {
      const ReslicePlane plane = longitudinal_plane(x_mm);
      PreparedSweep prepared(sweep.view());
      const BandImage before = render_planar(prepared, plane, thick(interpolation), serial);
      ASSERT_EQ(before.turned_parts, interpolation == Interpolation::nearest || x_mm < 20);
      TurnedFrames turned;
      SweepView some = sweep.view();
      some.frames = some.frames.first(25);
      for (const SweepView& view : {some, sweep.view()}) {
        turned.extend(view, any, serial);
        prepared.use_turned(&turned);
        const BandImage after = render_planar(prepared, plane, thick(interpolation), serial);
        EXPECT_TRUE(test::same_bits(before, after));
        const bool all = view.frames.size() == sweep.view().frames.size();
        EXPECT_FALSE(all && after.turned_parts);
      }
    }
  }
}

TEST(KeptTurned, GiveTheSameBitsOfRandomScenesThinnedOrNot) {
  Serial serial;
  for (unsigned seed = 5200; seed < 5230; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    PreparedSweep plain(scene.sweep.view(), scene.settings.gap), with(scene.sweep.view(), scene.settings.gap);
    TurnedFrames turned;
    turned.extend(scene.sweep.view(), any, serial);
    with.use_turned(&turned);
    for (const bool thinned : {false, true}) {
      scene.settings.thin_dense_frames = thinned;
      EXPECT_TRUE(test::same_bits(render_planar(plain, scene.plane, scene.settings, serial),
                                  render_planar(with, scene.plane, scene.settings, serial)))
          << seed;
    }
  }
}

TEST(KeptTurned, TakeTheMemoryAllowedOrNone) {
  Serial serial;
  const test::TestSweep sweep = noisy_sweep(40, 30, 20);
  // Rows of 30 pixels are stored as 32.
  constexpr std::size_t needed = std::size_t{20} * 40 * 32;
  TurnedFrames turned;
  turned.extend(sweep.view(), needed / 2, serial);
  EXPECT_EQ(turned.bytes(), 0U);
  const StopFlag stop{true};
  turned.extend(sweep.view(), any, serial, &stop);
  EXPECT_EQ(turned.bytes(), 0U);
  turned.extend(sweep.view(), needed, serial);
  EXPECT_EQ(turned.bytes(), needed);
  turned.extend(sweep.view(), needed, serial);
  EXPECT_EQ(turned.bytes(), needed) << "each is turned once";
  turned.clear();
  EXPECT_EQ(turned.bytes(), 0U);
  for (const FrameEntry& frame : entered(turned, sweep).frames) EXPECT_EQ(frame.turned, nullptr);
  const test::TestSweep narrow = noisy_sweep(least_turned_px - 1, 30, 3);
  turned.extend(narrow.view(), any, serial);
  EXPECT_EQ(turned.bytes(), 0U) << "the kernel turns squares of 16";
}

}  // namespace
}  // namespace sonoband
