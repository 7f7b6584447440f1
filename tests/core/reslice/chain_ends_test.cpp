// Planes along which pictures end: frames follow one another, but not all of them have every sample.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/reslice/paint.h"
#include "core/reslice/patch_kernels.h"
#include "core/reslice/tile.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/only_target.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/reference.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr int width = 150, height = 120;
constexpr double pixel_mm = 0.2;

Eigen::Matrix3d turned_by(double x_deg, double y_deg, double z_deg) {
  return (Eigen::AngleAxisd(x_deg * M_PI / 180, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(y_deg * M_PI / 180, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(z_deg * M_PI / 180, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

// Frames of noise 0.6 mm apart that turn and shift in themselves from one to the next, so that their edges
// are no frame's neighbour's.
test::TestSweep wobbling_sweep() {
  test::TestSweep sweep;
  std::mt19937_64 random(3);
  for (int i = 0; i < 26; ++i) {
    const Eigen::Matrix3d axes =
        turned_by(0.8 * std::sin(0.2 * i), 0.8 * std::sin(0.3 * i), 3 * std::sin(0.9 * i));
    sweep.add(width, height,
              test::image_pose(axes, {0.5 * std::sin(1.3 * i), 0.5 * std::cos(1.7 * i), 0.6 * i}, pixel_mm),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
  return sweep;
}

// A little more than a tile of 0.2 mm about a point.
ReslicePlane plane_about(const Eigen::Vector3d& middle, const Eigen::Matrix3d& axes) {
  constexpr int wide = 70, high = 66;
  return *make_plane(middle - 0.1 * wide * axes.col(0) - 0.1 * high * axes.col(1), axes.col(0), axes.col(1),
                     wide, high, pixel_mm);
}

// Parallel to the frames, along the sweep, C planes and slanted ones at a side, an end and a corner.
std::vector<ReslicePlane> planes_at_edges() {
  const std::array<Eigen::Vector3d, 3> middles = {Eigen::Vector3d(0, 10, 8), Eigen::Vector3d(15, 24, 8),
                                                  Eigen::Vector3d(29, 1, 8)};
  std::vector<ReslicePlane> planes;
  for (const Eigen::Vector3d& middle : middles) {
    for (const Eigen::Matrix3d& axes : {turned_by(0, 0, 0), turned_by(0, -90, 0), turned_by(90, 0, 0),
                                        turned_by(90, 0, 45), turned_by(35, 40, 25)})
      planes.push_back(plane_about(middle, axes));
  }
  return planes;
}

struct EndsCase {
  bool masked;
  double reach_mm;  // 0: automatic
};

class ChainsWithEnds : public testing::TestWithParam<EndsCase> {
 protected:
  ChainsWithEnds() {
    if (GetParam().masked) sweep.set_mask(test::sector_mask(width, height));
    settings.band = {2, 0.2};
    if (GetParam().reach_mm > 0) settings.gap.mm = GetParam().reach_mm;
  }

  // The plane's first tile is one chain in which pictures end.
  bool ends_in_a_chain(const ReslicePlane& plane) const {
    const Lattice lattice = plane_lattice(plane, settings.band);
    const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), settings.gap));
    Tile tile;
    return tile.find(seen, in_own_coordinates(lattice), all_frames(seen), Interpolation::nearest, true, 0,
                     0) &&
           tile.is_chain && !tile.chain.whole;
  }

  test::TestSweep sweep = wobbling_sweep();
  RenderSettings settings;
  Serial serial;
};

TEST_P(ChainsWithEnds, GiveTheDefinitionsPicturesButForTies) {
  int met = 0, how = 0;
  for (const ReslicePlane& plane : planes_at_edges()) {
    met += ends_in_a_chain(plane) ? 1 : 0;
    settings.compounding =
        std::array{Compounding::maximum, Compounding::minimum, Compounding::mean}[how++ % 3];
    const BandImage image = render_planar(sweep.view(), plane, settings, serial);
    EXPECT_EQ(test::beyond_ties(sweep.view(), plane, settings, image), 0) << "plane " << how - 1;
  }
  // An automatic reach hardly spans the gap: beyond the pictures, where frames spread, it does not.
  EXPECT_GE(met, settings.gap.mm ? 9 : 1) << "the planes are of no use here";
}

TEST_P(ChainsWithEnds, GiveTheSamePictureByEveryInstructionSet) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    test::Difference sum;
    for (const ReslicePlane& plane : planes_at_edges()) {
      const BandImage best = render_planar(sweep.view(), plane, settings, serial);
      const test::OnlyTarget only(target);
      ASSERT_EQ(patch_kernels().target, target);
      const test::Difference d = test::compare(best, render_planar(sweep.view(), plane, settings, serial));
      sum.pixels += d.pixels;
      sum.unequal += d.unequal;
    }
    EXPECT_GE(sum.equal_share(), 0.999) << hwy::TargetName(target) << ": " << sum.unequal;
  }
}

// A reach of 2 mm hands a sample on past several frames that do not have it.
INSTANTIATE_TEST_SUITE_P(Cases, ChainsWithEnds,
                         testing::Values(EndsCase{false, 0}, EndsCase{false, 0.4}, EndsCase{false, 2},
                                         EndsCase{true, 0.4}, EndsCase{true, 2}),
                         [](const auto& of) {
                           return std::string(of.param.masked ? "Masked" : "Plain") +
                                  (of.param.reach_mm > 1   ? "FarReach"
                                   : of.param.reach_mm > 0 ? "ShortReach"
                                                           : "AutomaticReach");
                         });

}  // namespace
}  // namespace sonoband
