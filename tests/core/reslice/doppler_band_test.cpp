// Bands of Doppler keys whose pictures are known in closed form: the paper's rules, sample by sample.
#include <gtest/gtest.h>

#include <vector>

#include "core/image/doppler.h"
#include "core/reslice/band.h"
#include "tests/support/test_sweep.h"

namespace sonoband {
namespace {

constexpr double pixel = 0.25;  // mm; a power of two, so that positions are exact

std::uint8_t key(int level, bool red) {
  return doppler::colour_key(level, red);
}

using Columns = std::vector<std::vector<std::uint8_t>>;

// Nine frames of 64x48 pixels, 0.5 mm apart along z, all the same: column x has `columns[x]` from row 10 on,
// else black.
test::TestSweep stack(const Columns& columns) {
  test::TestSweep sweep;
  for (int i = 0; i < 9; ++i)
    sweep.add(
        64, 48, test::image_pose(Eigen::Matrix3d::Identity(), {0, 0, i * 0.5}, pixel),
        [&](int x, int y, const auto&) {
          const bool inside =
              x < static_cast<int>(columns.size()) && y >= 10 && y < 10 + static_cast<int>(columns[x].size());
          return inside ? columns[x][y - 10] : std::uint8_t{0};
        },
        PixelKind::doppler);
  return sweep;
}

// The third row of a C plane through row `row`: along x, layers along y.
std::vector<std::uint8_t> line(const test::TestSweep& sweep, double row, int width,
                               const RenderSettings& settings) {
  Serial serial;
  const ReslicePlane plane =
      *make_plane({0, row * pixel, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), width, 5, pixel);
  const BandImage image = render_planar(sweep.view(), plane, settings, serial);
  EXPECT_EQ(image.kind, PixelKind::doppler);
  std::vector<std::uint8_t> values;
  for (int x = 0; x < width; ++x) values.push_back(image.pixels.view()(x, 2));
  return values;
}

RenderSettings three_layers(Compounding compounding) {
  RenderSettings settings;
  settings.band = {2 * pixel, pixel};
  settings.compounding = compounding;
  return settings;
}

// "Any coloured pixel is brighter than any grey; of the same intensity red is brighter than blue."
TEST(DopplerBand, MaximumAndMinimumFollowThePapersRules) {
  const Columns columns = {
      {10, 127, 31},                         // grey only
      {key(0, false), 127, 0},               // the darkest blue beats white
      {key(20, true), key(20, false), 127},  // red beats blue of the same level
      {key(20, true), key(21, false), 5},    // and not a brighter one
      {key(63, true), key(63, false), key(0, true)},
  };
  const auto sweep = stack(columns);
  EXPECT_EQ(line(sweep, 11, 5, three_layers(Compounding::maximum)),
            (std::vector<std::uint8_t>{127, key(0, false), key(20, true), key(21, false), key(63, true)}));
  EXPECT_EQ(line(sweep, 11, 5, three_layers(Compounding::minimum)),
            (std::vector<std::uint8_t>{10, 0, 127, 5, key(0, true)}));
}

TEST(DopplerBand, MeanFollowsTheVelocities) {
  const Columns columns = {
      {10, 20, 31},                         // grey only: 20.33
      {key(30, true), key(10, false), 50},  // (30 - 10 + 0) / 3 = 6.67
      {key(30, false), 7, 9},               // -10
      {key(1, true), key(1, false), 40},    // 0: the grey
      {key(0, true), key(0, false), key(0, true)},
  };
  EXPECT_EQ(line(stack(columns), 11, 5, three_layers(Compounding::mean)),
            (std::vector<std::uint8_t>{20, key(7, true), key(10, false), 40, 0}));
}

// A quarter of the way from row 10 to row 11: the taps weigh 3/4 and 1/4.
TEST(DopplerBand, LinearBlendsVelocitiesAndGreysApart) {
  const Columns columns = {
      {20, 61},                         // 30.25: greys as numbers
      {key(40, true), key(20, true)},   // 35: levels, not keys
      {key(40, true), key(20, false)},  // 30 - 5 = 25
      {key(8, false), 90},              // colour weighs 3/4: -8, the grey takes no part
      {90, key(8, false)},              // 1/4: the grey alone
      {key(10, true), key(30, false)},  // 7.5 - 7.5 = 0: the darkest red
      {key(10, false), key(32, true)},  // -7.5 + 8 = 0.5: away from zero
      {key(10, true), key(32, false)},
  };
  RenderSettings settings;
  settings.band = {0, pixel};
  settings.interpolation = Interpolation::linear;
  EXPECT_EQ(line(stack(columns), 10.25, 8, settings),
            (std::vector<std::uint8_t>{30, key(35, true), key(25, true), key(8, false), 90, key(0, true),
                                       key(1, true), key(1, false)}));
  // Half-way each weighs a half, which is enough for colour.
  EXPECT_EQ(line(stack(columns), 10.5, 5, settings),
            (std::vector<std::uint8_t>{41, key(30, true), key(10, true), key(8, false), key(8, false)}));
}

}  // namespace
}  // namespace sonoband
