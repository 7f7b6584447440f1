// Lattices in their own coordinates, in which planes are painted.
#include "core/reslice/lattice.h"

#include <gtest/gtest.h>

#include "tests/core/reslice/random_geometry.h"

namespace sonoband {
namespace {

Lattice lattice_of_scene(const test::RandomScene& scene) {
  const std::optional<Lattice> lattice = lattice_of(plane_lines(scene.plane, scene.settings.band));
  EXPECT_TRUE(lattice.has_value());
  return *lattice;
}

// Every foot and distance is that of World, at samples in and beyond the lattice.
TEST(LatticeCoordinates, LeaveFeetAndDistancesWhereTheyAre) {
  for (unsigned seed = 500; seed < 510; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const Lattice lattice = lattice_of_scene(scene);
    const FrameTable table = make_frame_table(scene.sweep.view(), scene.settings.gap);
    const FrameTable seen = seen_from(lattice, table);
    ASSERT_EQ(seen.frames.size(), table.frames.size());
    for (std::size_t i = 0; i < table.frames.size(); ++i) {
      const FrameEntry &world = table.frames[i], &own = seen.frames[i];
      for (const Eigen::Vector3d& at :
           {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(7, 3, 2), Eigen::Vector3d(-5, 90, 11)}) {
        const Eigen::Vector3d p = lattice.at(at.x(), at.y(), at.z());
        EXPECT_NEAR(own.x_px.at(at), world.x_px.at(p), 1e-9);
        EXPECT_NEAR(own.y_px.at(at), world.y_px.at(p), 1e-9);
        EXPECT_NEAR(own.z_mm.at(at), world.z_mm.at(p), 1e-9);
      }
      EXPECT_EQ(own.normal, world.z_mm.gradient) << "stays in World";
    }
    const Lattice own = in_own_coordinates(lattice);
    EXPECT_EQ(own.at(4, 5, 6), Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(own.samples, lattice.samples);
    EXPECT_EQ(own.rows, lattice.rows);
    EXPECT_EQ(own.layers, lattice.layers);
  }
}

// Of an affine function a block's extremes are at its corners, and its box has them.
TEST(LatticeCoordinates, BoxesHaveTheExtremesOfTheirCorners) {
  const AffineScalar f{{0.3, -1.7, 0.05}, 2};
  const LatticeBlock block{3, -4, 1, 5, 1, 7};
  double lowest = 1e9, highest = -1e9;
  for (const int a : {3, 7}) {
    for (const int l : {1, 7}) {
      lowest = std::min(lowest, f.at({static_cast<double>(a), -4, static_cast<double>(l)}));
      highest = std::max(highest, f.at({static_cast<double>(a), -4, static_cast<double>(l)}));
    }
  }
  const Span span = span_of(f, box_of(block));
  EXPECT_NEAR(span.lowest, lowest, 1e-12);
  EXPECT_NEAR(span.highest, highest, 1e-12);
}

}  // namespace
}  // namespace sonoband
