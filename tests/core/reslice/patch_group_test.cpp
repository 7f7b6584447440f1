// A chain's cells taken in many patches, one cell after another, as against patch after patch.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/reslice/chain_cells.h"
#include "core/reslice/paint.h"
#include "core/reslice/patch_kernels.h"
#include "core/reslice/tile.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/support/support.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr double pixel_mm = 0.2;
constexpr int tile_pixels = 64;

// Frames of noise that follow one another, `spacing_mm` apart, all turned a little.
test::TestSweep noise_sweep(std::mt19937_64& random, double spacing_mm) {
  std::uniform_real_distribution<double> radians(-0.06, 0.06);
  test::TestSweep sweep;
  const Eigen::Matrix3d axes = (Eigen::AngleAxisd(radians(random), Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(radians(random), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(radians(random), Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  for (int i = 0; i < 40; ++i) {
    sweep.add(110, 100, test::image_pose(axes, {0, 0, spacing_mm * (i - 20)}, pixel_mm),
              [&](int, int, const Eigen::Vector3d&) { return static_cast<std::uint8_t>(random()); });
  }
  return sweep;
}

// Patches of a tile at any place, some of whose lanes do not exist.
void fill(PatchGroup& group, const Tile& tile, std::mt19937_64& random) {
  std::uniform_int_distribution<int> place(0, tile_pixels - 1);
  group.count = 0;
  for (int i = 0; i < group_patches - 3; ++i) {
    const int da = place(random), db = place(random);
    const LaneMask lanes = existing_lanes(tile.grid, da, db, tile_pixels, tile_pixels);
    group.add({da, db, tile.block.depth, lanes});
  }
}

void expect_equal(const PatchSums& a, const PatchSums& b, Rule rule) {
  EXPECT_EQ(a.count, b.count);
  if (rule == Rule::maximum || rule == Rule::minimum) {
    EXPECT_EQ(a.extreme, b.extreme);
  } else {
    EXPECT_EQ(a.sum, b.sum);
  }
  if (rule == Rule::mean_doppler) {
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.coloured, b.coloured);
  }
}

PatchSums nothing(Rule rule) {
  PatchSums sums{};
  sums.extreme.fill(rule == Rule::minimum ? 255 : 0);
  return sums;
}

// Compares all patches of `group`; returns in how many of them a picture may end.
int compare(const ChainCells& cells, PatchGroup& group, Rule rule) {
  const PatchKernels& kernels = patch_kernels();
  const bool ends = !cells.reaches.empty();
  const int count = static_cast<int>(cells.boundaries.size()) - 1;
  using Without = std::array<LaneMask, patch_layers>;
  std::vector<Without> without(group_patches);
  std::vector<bool> edge(group_patches);
  for (int i = 0; i < group.count; ++i) group.sums[i] = nothing(rule);
  for (int cell = 0; cell < count; ++cell) {
    std::array<std::uint8_t, group_patches> at_edge{};
    const ChainBoundary* boundaries = cells.boundaries.data() + cell;
    const int edges = kernels.take_cell(cells.frames[cell], boundaries, ends, rule, group, at_edge.data());
    for (int i = 0; i < edges; ++i) {
      edge[at_edge[i]] = true;
      kernels.take_chain_ends(cells.frames.data() + cell, boundaries, 1, group.sites[at_edge[i]], rule,
                              group.sums[at_edge[i]], without[at_edge[i]].data());
    }
  }
  for (int i = 0; i < group.count; ++i) {
    PatchSums one = nothing(rule);
    Without left{};
    if (ends) {
      kernels.take_chain_ends(cells.frames.data(), cells.boundaries.data(), count, group.sites[i], rule, one,
                              left.data());
    } else {
      kernels.take_chain(cells.frames.data(), cells.boundaries.data(), count, group.sites[i], rule, one);
    }
    SCOPED_TRACE("patch " + std::to_string(i));
    expect_equal(group.sums[i], one, rule);
    EXPECT_EQ(without[i], left);
  }
  return static_cast<int>(std::count(edge.begin(), edge.end(), true));
}

TEST(PatchGroups, GetOfEachCellWhatPatchesGetOneByOne) {
  if (patch_kernels().take_cell == nullptr)
    GTEST_SKIP() << "asks for AVX-512 with VBMI, which takes cells in groups";
  int inner = 0, at_edge = 0, apart = 0;
  const auto group = std::make_unique<PatchGroup>();
  for (unsigned seed = 0; seed < 48; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const test::TestSweep sweep = noise_sweep(random, seed % 2 == 0 ? 0.15 : 0.6);
    // Of a tile in the middle of the pictures, and of one at their corner.
    const bool corner = seed % 3 == 0;
    const Eigen::Matrix3d axes = test::random_rotation(random);
    const Eigen::Vector3d middle = corner ? Eigen::Vector3d(3, 2, 0) : Eigen::Vector3d(11, 10, 0);
    const ReslicePlane plane = *make_plane(middle - 6.3 * (axes.col(0) + axes.col(1)), axes.col(0),
                                           axes.col(1), tile_pixels, tile_pixels, pixel_mm);
    RenderSettings settings;
    settings.band = {2.4, pixel_mm};
    settings.gap.mm = 1;
    const Lattice lattice = plane_lattice(plane, settings.band);
    const FrameTable seen = seen_from(lattice, make_frame_table(sweep.view(), settings.gap));
    const Lattice own = in_own_coordinates(lattice);
    Tile tile;
    if (!tile.find(seen, own, all_frames(seen), Interpolation::nearest, true, 0, 0) || !tile.is_chain) {
      ++apart;
      continue;
    }
    tile.open(own, Interpolation::nearest, false);
    ChainCells cells;
    lay_out(own, tile, tile.chain, tile.candidates, tile.box, 0, Interpolation::nearest, cells);
    fill(*group, tile, random);
    for (const Rule rule : {Rule::maximum, Rule::minimum, Rule::mean_grey, Rule::mean_doppler}) {
      const int edges = compare(cells, *group, rule);
      at_edge += edges;
      inner += group->count - edges;
    }
  }
  EXPECT_GE(inner, 500) << "patches whose pictures hold all";
  EXPECT_GE(at_edge, 500) << "patches in which pictures end";
  EXPECT_LE(apart, 12) << "tiles that are no chain";
}

}  // namespace
}  // namespace sonoband
