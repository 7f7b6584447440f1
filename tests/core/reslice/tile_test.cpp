// Which patches a tile is cut into.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sonoband
