// Which patches a tile is cut into.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/reslice/paint.h"
#include "core/reslice/tile.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

// The patches of the tile at sample a of a C plane through parallel frames of 400x100 pixels, the plane's
// first column being the pictures'.
LaneShape shape_at(int a, Interpolation interpolation) {
  test::TestSweep sweep;
  for (int i = 0; i < 60; ++i) {
    sweep.add(400, 100, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.5 * i}, 0.2),
              [](int x, int y, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x + y); });
  }
  // The picture's rows run along the sweep; its columns begin 6 mm before the frames'.
  const ReslicePlane plane =
      *make_plane({-6, 10, 4}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), 256, 64, 0.2);
  const Lattice lattice = plane_lattice(plane, {4, 0.2});
  const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), {}));
  const Lattice own = in_own_coordinates(lattice);
  Tile tile;
  EXPECT_TRUE(tile.find(seen, own, all_frames(seen), interpolation, false, a, 0));
  EXPECT_EQ(tile.is_chain, a >= 64);
  tile.open(own, interpolation, true);
  return tile.shape;
}

// Lanes along the pixel rows are cheapest; where the pictures' sides run through the tile all of such patches
// would meet them.
TEST(Tile, PatchesStandAlongThePicturesEdges) {
  for (const Interpolation interpolation : {Interpolation::nearest, Interpolation::linear}) {
    EXPECT_EQ(shape_at(64, interpolation).across, 64);
    EXPECT_LE(shape_at(0, interpolation).across, 32);
  }
}

// Frames along z, of pictures in x and y.
TEST(Tile, IsLongWhereDistancesChangeLittle) {
  test::TestSweep sweep;
  for (int i = 0; i < 60; ++i) {
    sweep.add(100, 100, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.5 * i}, 0.2),
              [](int x, int y, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(x + y); });
  }
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const auto size = [&](const Eigen::Vector3d& right, const Eigen::Vector3d& down,
                        Interpolation interpolation) {
    const Lattice lattice = plane_lattice(*make_plane({2, 2, 2}, right, down, 100, 90, 0.2), {14, 0.2});
    const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), {}));
    const TileSize s = tile_size(seen, lattice.layers, interpolation);
    return std::pair(s.across, s.down);
  };
  EXPECT_EQ(size(x, z, Interpolation::nearest), std::pair(128, 32));
  EXPECT_EQ(size(z, x, Interpolation::nearest), std::pair(32, 128));
  EXPECT_EQ(size(x, y, Interpolation::nearest), std::pair(256, 64))
      << "all frames of the layers are in every tile";
  EXPECT_EQ(size((y + z).normalized(), (y - z).normalized(), Interpolation::nearest), std::pair(128, 64));
  EXPECT_EQ(size(x, (y + std::sqrt(3) * z).normalized(), Interpolation::nearest), std::pair(256, 64))
      << "lines run along the frames, and layers so much across them that fewer rows would not help";
  EXPECT_EQ(size(x, z, Interpolation::linear), std::pair(64, 64));
}

}  // namespace
}  // namespace sonoband
