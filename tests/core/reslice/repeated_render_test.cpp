// Renderings that build on earlier ones or on a growing sweep give the bits of a fresh one.
#include <gtest/gtest.h>

#include <random>
#include <thread>

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
      // 13 layers in four blocks at most, and one ahead on either side.
      EXPECT_LE(rolling.layers_painted(), 6 * RollingBand::block_layers);
    }
  }
}

// Layer i from a plane's on, as a rolling band that began at the plane shows it when it comes straight there.
BandImage thin_layer(PreparedSweep& sweep, ReslicePlane plane, RenderSettings settings, int i) {
  Serial serial;
  RollingBand rolling;
  settings.band.thickness_mm = 2 * (std::abs(i) + 1) * settings.band.step_mm;
  settings.compounding = Compounding::maximum;
  rolling.render(sweep, plane, settings, serial);
  plane.origin = plane.origin + (i * settings.band.step_mm) * plane.normal();
  rolling.render(sweep, plane, settings, serial);
  settings.band.thickness_mm = 0;
  BandImage image = rolling.render(sweep, plane, settings, serial);
  EXPECT_GT(rolling.layers_painted(), i == 0 ? -1 : 0);
  return image;
}

// The definition of a rolling band: pixel by pixel over its layers.
BandImage stacked(PreparedSweep& sweep, const ReslicePlane& anchor, const RenderSettings& settings,
                  int middle) {
  const int side = (settings.band.layers() - 1) / 2;
  BandImage out{Pixels(anchor.width, anchor.height), ImageBuffer<std::uint16_t>(anchor.width, anchor.height),
                PixelKind::grey};
  ImageBuffer<std::uint32_t> sums(anchor.width, anchor.height);
  for (int i = middle - side; i <= middle + side; ++i) {
    const BandImage layer = thin_layer(sweep, anchor, settings, i);
    for (int y = 0; y < anchor.height; ++y) {
      for (int x = 0; x < anchor.width; ++x) {
        if (layer.coverage.view()(x, y) == 0) continue;
        const std::uint8_t v = layer.pixels.view()(x, y);
        std::uint8_t& best = out.pixels.view()(x, y);
        const bool first = out.coverage.view()(x, y)++ == 0;
        sums.view()(x, y) += v;
        best = first                                          ? v
               : settings.compounding == Compounding::minimum ? std::min(best, v)
                                                              : std::max(best, v);
      }
    }
  }
  if (settings.compounding != Compounding::mean) return out;
  for (int y = 0; y < anchor.height; ++y) {
    for (int x = 0; x < anchor.width; ++x) {
      const std::uint32_t n = out.coverage.view()(x, y);
      if (n > 0) out.pixels.view()(x, y) = static_cast<std::uint8_t>((2 * sums.view()(x, y) + n) / (2 * n));
    }
  }
  return out;
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
      ASSERT_TRUE(test::same_bits(image, stacked(sweep, anchor, scene.settings, middle)))
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
      const test::Difference d = test::compare(thin_layer(sweep, scene.plane, scene.settings, i),
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

// Sets a flag once it has run so many bodies.
class StopsAfter final : public Parallel {
 public:
  StopsAfter(int bodies, StopFlag& stop) : left_(bodies), stop_(stop) {}
  int width() const override { return 1; }
  void for_each(int count, const std::function<void(int)>& body) override {
    for (int i = 0; i < count; ++i) {
      body(i);
      if (--left_ == 0) stop_ = true;
    }
  }

 private:
  int left_;
  StopFlag& stop_;
};

// A scene of many strips: seven across and four down.
test::RandomScene wide_scene(unsigned seed) {
  test::RandomScene scene = test::random_scene(seed);
  scene.plane.width = 840;
  scene.plane.height = 200;
  scene.plane.pixel_mm /= 8;
  scene.settings.compounding = Compounding::maximum;
  scene.settings.interpolation = Interpolation::nearest;
  scene.settings.band.thickness_mm = 10 * scene.settings.band.step_mm;
  return scene;
}

TEST(RollingBand, LayersGotReadyAreThoseOfADragAndCostItNothing) {
  for (unsigned seed = 3380; seed < 3386; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    Serial serial;
    PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
    const bool doppler = sweep.view().frames.front()->bscan.kind == PixelKind::doppler;
    scene.settings.compounding = static_cast<Compounding>(seed % (doppler ? 2 : 3));
    scene.settings.band.thickness_mm = 10 * scene.settings.band.step_mm;
    const ReslicePlane anchor = scene.plane;
    RollingBand rolling;
    EXPECT_EQ(rolling.layers_missing(sweep, anchor, scene.settings), std::nullopt);
    EXPECT_TRUE(rolling.prepare(sweep, anchor, scene.settings, serial));
    const int painted = rolling.layers_painted();
    EXPECT_EQ(painted, 4 * RollingBand::block_layers)
        << "layers -5 to 5 in two blocks, and one on either side";
    for (const int middle : {0, 3, -4, 0}) {
      scene.plane.origin = anchor.origin + (middle * scene.settings.band.step_mm) * anchor.normal();
      EXPECT_EQ(rolling.layers_missing(sweep, scene.plane, scene.settings), 0);
      const BandImage image = rolling.render(sweep, scene.plane, scene.settings, serial);
      ASSERT_TRUE(test::same_bits(image, stacked(sweep, anchor, scene.settings, middle)))
          << "seed " << seed << ", middle " << middle;
    }
    EXPECT_LE(rolling.bytes(), RollingBand::most_bytes(anchor, scene.settings));
    // Of at most 11 + 2 (8 + 8) + 2 x 15 = 73 layers: two bytes and two bits of a pixel each; two blocks and
    // 16 runs to spare, counts and sums.
    const std::size_t pixels = static_cast<std::size_t>(anchor.width) * anchor.height;
    EXPECT_LE(RollingBand::most_bytes(anchor, scene.settings),
              pixels * (73 * 17 / 8 + 2 + 2 * 18 + 16 + 16 + 6));
    rolling.clear();
    EXPECT_EQ(rolling.bytes(), 0U);
    EXPECT_EQ(rolling.layers_missing(sweep, anchor, scene.settings), std::nullopt);
  }
}

TEST(RollingBand, GettingReadyEndsWhenToldAndGoesOnFromThere) {
  test::RandomScene scene = wide_scene(3390);
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  RollingBand whole, pieces;
  ASSERT_TRUE(whole.prepare(sweep, scene.plane, scene.settings, serial));
  int turns = 0;
  for (bool ready = false; !ready; ++turns) {
    ASSERT_LT(turns, 100) << "nothing that was painted is kept";
    StopFlag stop{false};
    StopsAfter parallel(3, stop);
    ready = pieces.prepare(sweep, scene.plane, scene.settings, parallel, &stop);
    if (turns == 0) {
      EXPECT_FALSE(ready);
      EXPECT_GT(*pieces.layers_missing(sweep, scene.plane, scene.settings), 0);
    }
    // Half of the way through the plane moves on and comes back.
    if (turns == 3) {
      ReslicePlane on = scene.plane;
      on.origin = on.origin + (3 * scene.settings.band.step_mm) * on.normal();
      EXPECT_TRUE(test::same_bits(pieces.render(sweep, on, scene.settings, serial),
                                  whole.render(sweep, on, scene.settings, serial)));
    }
  }
  EXPECT_GT(turns, 5);
  EXPECT_EQ(pieces.layers_missing(sweep, scene.plane, scene.settings), 0);
  EXPECT_TRUE(test::same_bits(pieces.render(sweep, scene.plane, scene.settings, serial),
                              whole.render(sweep, scene.plane, scene.settings, serial)));
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
