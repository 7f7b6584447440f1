// Drags and changes of thickness by kept layers give the bits of the layers.
#include "core/reslice/rolling_band.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/stacked_layers.h"

namespace sonoband {
namespace {

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
      // 13 layers in four blocks at most, and one ahead on either side.
      EXPECT_LE(rolling.layers_painted(), 6 * RollingBand::block_layers);
    }
  }
}

TEST(RollingBand, AnyRunOfDragsAndThicknessesGivesTheBitsOfItsLayers) {
  for (unsigned seed = 3300; seed < 3312; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    const bool doppler = sweep.view().frames.front()->bscan.kind == PixelKind::doppler;
    RollingBand rolling;
    const ReslicePlane anchor = scene.plane;
    scene.settings.interpolation = seed % 3 == 0 ? Interpolation::linear : Interpolation::nearest;
    const double step = scene.settings.band.step_mm;
    std::mt19937 random(seed);
    const auto pick = [&](int least, int most) {
      return least + static_cast<int>(random() % (most - least + 1));
    };
    scene.settings.band.thickness_mm = 6 * step;
    scene.settings.compounding = Compounding::maximum;
    rolling.render(sweep, anchor, scene.settings, serial);
    int middle = 0;
    for (int i = 0; i < 24; ++i) {
      middle += i == 0 ? 1 : pick(-3, 3);
      scene.settings.band.thickness_mm = 2 * pick(1, 6) * step;
      scene.settings.compounding = static_cast<Compounding>(pick(0, doppler ? 1 : 2));
      ReslicePlane plane = anchor;
      plane.origin = plane.origin + (middle * step) * plane.normal();
      const BandImage image = rolling.render(sweep, plane, scene.settings, serial);
      if (rolling.layers_painted() == 0) {  // so long a jump that it is a new picture
        EXPECT_TRUE(test::same_bits(image, render_planar(sweep, plane, scene.settings, serial)));
        break;
      }
      ASSERT_TRUE(test::same_bits(image, test::stacked(sweep, anchor, scene.settings, middle)))
          << "seed " << seed << ", step " << i;
      EXPECT_LE(rolling.bytes(), RollingBand::most_bytes(plane, scene.settings));
    }
  }
}

// A thicker band is the one before and the layers about it; a thinner one is found again; a drag leaves both
// behind.
TEST(RollingBand, GrowingAndShrinkingGivesTheBitsOfABandThatComesStraight) {
  for (unsigned seed = 3400; seed < 3406; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    scene.settings.interpolation = Interpolation::nearest;
    scene.settings.compounding = seed % 2 == 0 ? Compounding::maximum : Compounding::minimum;
    const double step = scene.settings.band.step_mm;
    const ReslicePlane anchor = scene.plane;
    scene.settings.band.thickness_mm = 16 * step;
    RollingBand rolling;
    ASSERT_TRUE(rolling.prepare(sweep, anchor, scene.settings, serial));
    std::mt19937 random(seed);
    int side = 8, middle = 0;
    for (int i = 0; i < 80; ++i) {
      // More than are kept grow one out of another at first.
      const unsigned kind = i < 24 ? 0 : random() % 8;
      side = std::max(kind < 4 ? side + 1 : kind < 6 ? side - 1 : kind == 6 ? side - 5 : side, 4);
      middle += kind == 7 ? 1 - 2 * static_cast<int>(random() % 2) : 0;
      scene.settings.band.thickness_mm = 2 * side * step;
      ReslicePlane plane = anchor;
      plane.origin = plane.origin + (middle * step) * plane.normal();
      const BandImage image = rolling.render(sweep, plane, scene.settings, serial);
      RollingBand straight;
      straight.prepare(sweep, anchor, scene.settings, serial);
      ASSERT_TRUE(test::same_bits(image, straight.render(sweep, plane, scene.settings, serial)))
          << "seed " << seed << ", step " << i;
      EXPECT_LE(rolling.bytes(), RollingBand::most_bytes(plane, scene.settings));
    }
  }
}

TEST(RollingBand, ALayerIsRenderPlanarsThinPictureButForTies) {
  test::Difference sum;
  for (unsigned seed = 3340; seed < 3352; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    scene.settings.interpolation = seed % 3 == 0 ? Interpolation::linear : Interpolation::nearest;
    scene.settings.compounding = Compounding::maximum;
    for (const int i : {-9, -1, 3, 20}) {
      RenderSettings thin = scene.settings;
      thin.band.thickness_mm = 0;
      ReslicePlane plane = scene.plane;
      plane.origin = plane.origin + (i * thin.band.step_mm) * plane.normal();
      const test::Difference d = test::compare(test::thin_layer(sweep, scene.plane, scene.settings, i),
                                               render_planar(sweep, plane, thin, serial));
      sum.pixels += d.pixels;
      sum.unequal += d.unequal;
    }
  }
  EXPECT_GE(sum.equal_share(), 0.999) << sum.unequal << " of " << sum.pixels;
}

// A strip on a thread of its own, the last one first.
class Threads final : public Parallel {
 public:
  int width() const override { return 3; }
  void for_each(int count, const std::function<void(int)>& body) override {
    for (int i = count; i > 0; i -= 3) {
      std::vector<std::thread> threads;
      for (int j = i - 1; j >= std::max(i - 3, 0); --j) threads.emplace_back([&body, j] { body(j); });
      for (std::thread& t : threads) t.join();
    }
  }
};

// Threads, and layers that were something else before.
TEST(RollingBand, ThreadsAndReusedMemoryChangeNothing) {
  Threads workers;
  Serial serial;
  for (unsigned seed = 3360; seed < 3366; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    scene.settings.compounding = seed % 2 == 0 ? Compounding::maximum : Compounding::minimum;
    scene.settings.band.thickness_mm = 8 * scene.settings.band.step_mm;
    RollingBand one, other;
    // The other's memory has held a plane turned about its normal.
    ReslicePlane turned = scene.plane;
    turned.right = scene.plane.down;
    turned.down = Direction<frame::World>{-scene.plane.right.v};
    for (int i = 0; i < 3; ++i) {
      other.render(sweep, turned, scene.settings, workers);
      turned.origin = turned.origin + scene.settings.band.step_mm * turned.normal();
    }
    for (int i = 0; i < 20; ++i) {
      const BandImage a = one.render(sweep, scene.plane, scene.settings, serial);
      const BandImage b = other.render(sweep, scene.plane, scene.settings, workers);
      ASSERT_TRUE(test::same_bits(a, b)) << "seed " << seed << ", step " << i;
      scene.plane.origin = scene.plane.origin + scene.settings.band.step_mm * scene.plane.normal();
    }
  }
}

TEST(RollingBand, AStepPaintsWhatIsNewAndOnlyAMoveStartsLayers) {
  test::RandomScene scene = test::random_scene(3301);
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  scene.settings.compounding = Compounding::maximum;
  scene.settings.band.thickness_mm = 10 * scene.settings.band.step_mm;
  RollingBand rolling;
  const auto render = [&] { return rolling.render(sweep, scene.plane, scene.settings, serial); };
  render();
  scene.settings.compounding = Compounding::minimum;
  EXPECT_TRUE(test::same_bits(render(), render_planar(sweep, scene.plane, scene.settings, serial)));
  EXPECT_EQ(rolling.layers_painted(), 0);
  const auto drag = [&](int steps) {
    scene.plane.origin = scene.plane.origin + (steps * scene.settings.band.step_mm) * scene.plane.normal();
    render();
    return rolling.layers_painted();
  };
  // Layers -4 to 6 lie in the blocks of -16 to 15; a picture this small is one strip, so the block that comes
  // is painted with the first step towards it.
  EXPECT_EQ(drag(1), 48);
  EXPECT_EQ(drag(1), 48);
  EXPECT_EQ(drag(1), 48);
  EXPECT_EQ(drag(-1), 64);
  EXPECT_EQ(drag(-2), 64);
  EXPECT_EQ(drag(-4), 64);
  scene.settings.band.thickness_mm = 6 * scene.settings.band.step_mm;
  EXPECT_EQ(drag(0), 64);
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
