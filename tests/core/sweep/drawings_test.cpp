// What a scanner draws over its Doppler pictures is masked out of a sweep; tissue and flow stay.
#include "core/sweep/drawings.h"

#include <gtest/gtest.h>

#include <random>

#include "core/image/doppler.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr int width = 60, height = 40;

bool in_box(int x, int y) {
  const bool inside = x >= 20 && x <= 40 && y >= 10 && y <= 30;
  return inside && (x == 20 || x == 40 || y == 10 || y == 30);
}

// Speckle with a white box, flow of one velocity within, and fluid that is as dark in every frame.
test::TestSweep sweep_with_box(int frames, double step_mm, PixelKind kind = PixelKind::doppler) {
  test::TestSweep sweep;
  std::mt19937 random(7);
  for (int i = 0; i < frames; ++i) {
    sweep.add(
        width, height, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, step_mm * i}, 0.3),
        [&](int x, int y, const Eigen::Vector3d&) -> std::uint8_t {
          if (in_box(x, y)) return 125 + random() % 3;
          if (x > 26 && x < 34 && y > 16 && y < 24) return doppler::colour_key(40, true);
          if (y > 35) return 3;
          return static_cast<std::uint8_t>(random() % 128);
        },
        kind);
  }
  return sweep;
}

TEST(Drawings, ABoxThatNeverMovesIsMaskedAndNothingElse) {
  const test::TestSweep sweep = sweep_with_box(40, 0.4);
  const Pixels mask = mask_without_drawings(sweep.view());
  ASSERT_FALSE(mask.view().empty());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool beside = false;  // capture blurs by a pixel
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u) beside = beside || in_box(u, v);
      ASSERT_EQ(mask.view()(x, y) == 0, beside) << x << "," << y;
    }
  }
}

TEST(Drawings, TheSweepsOwnMaskStays) {
  test::TestSweep sweep = sweep_with_box(40, 0.4);
  Pixels own(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) own.view()(x, y) = x < 50 ? 255 : 0;
  sweep.set_mask(std::move(own));
  const Pixels mask = mask_without_drawings(sweep.view());
  EXPECT_EQ(mask.view()(55, 5), 0);
  EXPECT_EQ(mask.view()(20, 20), 0);
  EXPECT_NE(mask.view()(5, 5), 0);
}

// A still probe shows a still picture; few frames prove nothing; and grey sweeps have no box.
TEST(Drawings, WhatCannotBeToldFromTissueStays) {
  EXPECT_TRUE(mask_without_drawings({}).view().empty());
  const auto masked = [](const test::TestSweep& sweep) {
    const Pixels mask = mask_without_drawings(sweep.view());
    return !mask.view().empty() && mask.view()(20, 20) == 0;
  };
  EXPECT_TRUE(masked(sweep_with_box(8, 0.4)));
  EXPECT_FALSE(masked(sweep_with_box(40, 0.01)));
  EXPECT_FALSE(masked(sweep_with_box(7, 0.4)));
  EXPECT_FALSE(masked(sweep_with_box(1, 0.4)));
  EXPECT_FALSE(masked(sweep_with_box(40, 0.4, PixelKind::grey)));
}

}  // namespace
}  // namespace sonoband
