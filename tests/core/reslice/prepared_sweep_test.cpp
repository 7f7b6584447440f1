// A sweep prepared frame by frame gives the bits of one given at once.
#include "core/reslice/prepared_sweep.h"

#include <gtest/gtest.h>

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
}

}  // namespace
}  // namespace sonoband
