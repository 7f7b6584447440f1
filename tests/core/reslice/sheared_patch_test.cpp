// Patches sheared along the frames' traces, and of frames turned.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/reslice/tile.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/reference.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

// Patches at multiples of their sides, as BandPainter puts them, hold every pixel of a block exactly once.
TEST(ShearedPatches, CoverABlockOnce) {
  constexpr int width = 50, height = 37;
  for (int across = 1; across <= patch_lanes; across *= 2) {
    for (const double slope : {-2.0, -1.0, -0.45, 0.0, 0.03, 0.5, 1.7}) {
      for (const LaneShape shape : {LaneShape{across, slope, 0}, LaneShape{across, 0, slope}}) {
        const LaneGrid grid = lane_grid(shape);
        std::vector<int> held(static_cast<std::size_t>(width) * height);
        for (int db = -4 * patch_lanes; db < height + 3 * patch_lanes; ++db) {
          for (int da = -4 * patch_lanes; da < width + 3 * patch_lanes; ++da) {
            if (da % shape.across != 0 || db % shape.down() != 0) continue;
            const LaneMask lanes = existing_lanes(grid, da, db, width, height);
            for (int k = 0; k < patch_lanes; ++k) {
              const int a = da + shape.a(k), b = db + shape.b(k);
              const bool inside = a >= 0 && b >= 0 && a < width && b < height;
              ASSERT_EQ((lanes >> k & 1) != 0, inside) << k;
              if (inside) ++held[static_cast<std::size_t>(b) * width + a];
            }
          }
        }
        for (const int count : held) ASSERT_EQ(count, 1) << across << " across, slope " << slope;
      }
    }
  }
}

TEST(ShearedPatches, RunsAreTheLanes) {
  for (int across = 1; across <= patch_lanes; across *= 2) {
    for (const LaneShape shape : {LaneShape{across, 0.7, 0}, LaneShape{across, 0, -0.3}}) {
      const LaneGrid grid = lane_grid(shape);
      int lane = 0;
      for (int i = 0; i < grid.run_count; ++i) {
        const LaneRun& run = grid.runs[i];
        ASSERT_EQ(run.lane, lane);
        for (int j = 0; j < run.count; ++j, ++lane) {
          EXPECT_EQ(run.a + j, shape.a(lane));
          EXPECT_EQ(run.b, shape.b(lane));
          EXPECT_GE(shape.a(lane), grid.least_a);
          EXPECT_LE(shape.a(lane), grid.greatest_a);
          EXPECT_GE(shape.b(lane), grid.least_b);
          EXPECT_LE(shape.b(lane), grid.greatest_b);
        }
      }
      EXPECT_EQ(lane, patch_lanes);
    }
  }
}

// Frames of noise with a hand's wobble, `spacing_mm` apart, that follow one another.
void add_frames(test::TestSweep& sweep, double spacing_mm) {
  std::mt19937_64 random(5);
  for (int i = 0; i * spacing_mm < 24; ++i) {
    const double z = spacing_mm * i;
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.02 * std::sin(0.4 * z), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.02 * std::sin(0.3 * z), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(0.03 * std::sin(0.2 * z), Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    sweep.add(150, 120, test::image_pose(axes, {0, 0, z}, 0.2),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
}

// Planes in which frames' traces run at an angle, or pixel columns along them, well inside the pictures.
std::vector<ReslicePlane> slanted_planes() {
  std::vector<ReslicePlane> planes;
  for (const auto& [x, y, z] :
       {std::array{90.0, 0.0, 45.0}, std::array{90.0, 0.0, 3.0}, std::array{90.0, 0.0, 120.0},
        std::array{35.0, 40.0, 25.0}, std::array{0.0, -90.0, 0.0}, std::array{0.0, -90.0, 10.0}}) {
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(x * M_PI / 180, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(y * M_PI / 180, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(z * M_PI / 180, Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    const Eigen::Vector3d middle(15, 12, 12);
    planes.push_back(
        *make_plane(middle - 7.4 * axes.col(0) - 5.0 * axes.col(1), axes.col(0), axes.col(1), 75, 51, 0.2));
  }
  return planes;
}

class ShearedPatchesOf : public testing::TestWithParam<double> {};

TEST_P(ShearedPatchesOf, FramesGiveTheReferencesPictures) {
  test::TestSweep sweep;
  add_frames(sweep, GetParam());
  RenderSettings settings;
  settings.band = {2, 0.2};
  Serial serial;
  int sheared = 0, turned = 0;
  for (const ReslicePlane& plane : slanted_planes()) {
    for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
      settings.interpolation = interpolation;
      for (const Compounding how : {Compounding::maximum, Compounding::minimum, Compounding::mean}) {
        settings.compounding = how;
        const BandImage image = render_planar(sweep.view(), plane, settings, serial);
        const BandImage truth = test::reference_planar(sweep.view(), plane, settings);
        const test::Difference d = test::compare(image, truth);
        if (interpolation == Interpolation::nearest) {
          EXPECT_GE(d.equal_share(), 0.995);
          EXPECT_EQ(test::beyond_ties(sweep.view(), plane, settings, image), 0);
        } else {
          EXPECT_GE(d.close_share(), 0.999);
        }
      }
      const Lattice lattice = *lattice_of(plane_lines(plane, settings.band));
      const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), settings.gap));
      Tile tile;
      const Lattice own = in_own_coordinates(lattice);
      ASSERT_TRUE(tile.find(seen, own, all_frames(seen), interpolation, false, 0, 0));
      ASSERT_TRUE(tile.is_chain);
      tile.open(own, interpolation, true);
      sheared += tile.shape.sheared() ? 1 : 0;
      turned += tile.turned ? 1 : 0;
    }
  }
  EXPECT_GE(sheared, 3) << "the planes are of no use here";
  EXPECT_GE(turned, 2) << "the planes are of no use here";
}

// A plane along the sweep whose first rows and layers lie before the pictures' first pixels, by less than
// half of one, and one at their other ends: taps beyond an edge count as the edge.
TEST(TurnedFrames, EndAtThePicturesEdges) {
  test::TestSweep sweep;
  std::mt19937_64 random(8);
  constexpr int width = 60, height = 70;
  for (int i = 0; i < 50; ++i) {
    sweep.add(width, height, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.43 * i}, 0.2),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
  RenderSettings settings;
  settings.band = {4, 0.2};
  Serial serial;
  const double half_mm = settings.band.offset_mm(settings.band.layers() - 1);
  for (const bool last : {false, true}) {
    const double x = last ? (width - 1 + 0.3) * 0.2 - half_mm : -0.3 * 0.2 + half_mm;
    const double y = last ? (height - 1 + 0.4 - 63) * 0.2 : -0.4 * 0.2;
    const ReslicePlane plane =
        *make_plane({x, y, 3}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 64, 64, 0.2);
    for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
      settings.interpolation = interpolation;
      settings.compounding = Compounding::mean;
      const BandImage image = render_planar(sweep.view(), plane, settings, serial);
      const test::Difference d = test::compare(image, test::reference_planar(sweep.view(), plane, settings));
      EXPECT_GE(interpolation == Interpolation::nearest ? d.equal_share() : d.close_share(), 0.999);
      const Lattice lattice = *lattice_of(plane_lines(plane, settings.band));
      const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), settings.gap));
      Tile tile;
      ASSERT_TRUE(tile.find(seen, in_own_coordinates(lattice), all_frames(seen), interpolation, false, 0, 0));
      tile.open(in_own_coordinates(lattice), interpolation, true);
      EXPECT_TRUE(tile.turned) << "the plane is of no use here";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Spacings, ShearedPatchesOf, testing::Values(0.5, 0.15));

}  // namespace
}  // namespace sonoband
