// Renderings that build on earlier ones or on a growing sweep give the bits of a fresh one.
#include <gtest/gtest.h>

#include "core/reslice/prepared_sweep.h"
#include "core/reslice/rolling_band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"

namespace sonoband {
namespace {

TEST(PreparedSweep, GrownFrameByFrameIsAsGivenAtOnce) {
  for (unsigned seed = 3000; seed < 3010; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep grown({{}, scene.sweep.view().mask}, scene.settings.gap);
    for (const auto& f : scene.sweep.frames()) {
      grown.append(*f);
      grown.prepare();
    }
    const BandImage image = render_planar(grown, scene.plane, scene.settings, serial);
    EXPECT_TRUE(
        test::same_bits(image, render_planar(scene.sweep.view(), scene.plane, scene.settings, serial)));
  }
}

TEST(PreparedSweep, StopsBeforePaintingWhenTold) {
  test::RandomScene scene = test::random_scene(3001);
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  const StopFlag stop{true};
  const BandImage image = render_planar(sweep, scene.plane, scene.settings, serial, &stop);
  for (int y = 0; y < scene.plane.height; ++y)
    for (int x = 0; x < scene.plane.width; ++x) ASSERT_EQ(image.coverage.view()(x, y), 0);
  bool shown = false;
  render_progressively(sweep, scene.plane, scene.settings, 4, serial, &stop,
                       [&](const BandImage&, int) { shown = true; });
  EXPECT_FALSE(shown);
}

TEST(PreparedSweep, CoarsePictureHasPixelsOfTheFullThinOne) {
  for (unsigned seed = 3020; seed < 3026; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    scene.settings.band.thickness_mm = 0;
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    std::vector<std::pair<BandImage, int>> pictures;
    render_progressively(
        sweep, scene.plane, scene.settings, 3, serial, nullptr,
        [&](BandImage image, int factor) { pictures.emplace_back(std::move(image), factor); });
    ASSERT_EQ(pictures.size(), 2U);
    EXPECT_EQ(pictures[0].second, 3);
    EXPECT_EQ(pictures[1].second, 1);
    const BandImage& coarse = pictures[0].first;
    int unequal = 0, pixels = 0;
    for (int y = 0; y < coarse.pixels.height(); ++y) {
      for (int x = 0; x < coarse.pixels.width(); ++x, ++pixels)
        unequal += coarse.pixels.view()(x, y) != pictures[1].first.pixels.view()(3 * x, 3 * y) ? 1 : 0;
    }
    EXPECT_LE(unequal, 1 + pixels / 200) << "seed " << seed;
  }
}

TEST(RollingBand, DragAndThicknessGiveTheFreshBandButForTies) {
  for (unsigned seed = 3100; seed < 3116; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    RollingBand rolling;
    const double step = scene.settings.band.step_mm;
    int painted = 0;
    for (const double move : {0.0, 1.0, 1.0, -3.0, 0.0, 2.0}) {
      scene.plane.origin = scene.plane.origin + (move * step) * scene.plane.normal();
      scene.settings.band.thickness_mm = move == 0 ? 7 * step : 5 * step;
      scene.settings.compounding = static_cast<Compounding>((painted++) % 3);
      const BandImage image = rolling.render(sweep, scene.plane, scene.settings, serial);
      const BandImage fresh = render_planar(sweep, scene.plane, scene.settings, serial);
      EXPECT_GE(test::compare(image, fresh).equal_share(), 0.995) << "seed " << seed << ", move " << move;
    }
    const bool mean_of_doppler = sweep.view().frames.front()->bscan.kind == PixelKind::doppler;
    if (!mean_of_doppler) {
      EXPECT_LE(rolling.layers_painted(), 9 + 5);
    }
  }
}

TEST(RollingBand, TurnedPlaneAndGrownSweepArePaintedAnew) {
  test::RandomScene scene = test::random_scene(3201);
  Serial serial;
  PreparedSweep sweep({{}, scene.sweep.view().mask}, scene.settings.gap);
  RollingBand rolling;
  scene.settings.compounding = Compounding::maximum;
  for (const auto& f : scene.sweep.frames()) {
    sweep.append(*f);
    const BandImage image = rolling.render(sweep, scene.plane, scene.settings, serial);
    EXPECT_TRUE(test::same_bits(image, render_planar(sweep, scene.plane, scene.settings, serial)));
  }
  std::swap(scene.plane.right, scene.plane.down);
  const BandImage image = rolling.render(sweep, scene.plane, scene.settings, serial);
  EXPECT_GE(test::compare(image, render_planar(sweep, scene.plane, scene.settings, serial)).equal_share(),
            0.995);
}

}  // namespace
}  // namespace sonoband
