// Laws that hold for the band of any sweep.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <random>
#include <thread>

#include "core/reslice/band.h"
#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"
#include "tests/core/reslice/reference.h"

namespace sonoband {
namespace {

// Threads that take bodies in whatever order they come.
class Threads final : public Parallel {
 public:
  explicit Threads(int width) : width_(width) {}
  int width() const override { return width_; }
  void for_each(int count, const std::function<void(int)>& body) override {
    std::mutex mutex;
    int next = count;
    const auto work = [&] {
      for (;;) {
        int i = 0;
        {
          const std::lock_guard lock(mutex);
          i = --next;
        }
        if (i < 0) return;
        body(i);
      }
    };
    std::vector<std::thread> helpers;
    for (int i = 1; i < width_; ++i) helpers.emplace_back(work);
    work();
    for (std::thread& t : helpers) t.join();
  }

 private:
  int width_;
};

BandImage render(const test::RandomScene& scene) {
  Serial serial;
  return render_planar(scene.sweep.view(), scene.plane, scene.settings, serial);
}

class Laws : public testing::TestWithParam<unsigned> {};

TEST_P(Laws, MinimumMeanMaximumAreOrdered) {
  test::RandomScene scene = test::random_scene(GetParam());
  if (scene.sweep.frames().front()->bscan.kind == PixelKind::doppler) {
    for (auto& f : scene.sweep.frames()) f->bscan.kind = PixelKind::grey;
  }
  const auto with = [&](Compounding how) {
    scene.settings.compounding = how;
    return render(scene);
  };
  const BandImage low = with(Compounding::minimum), mean = with(Compounding::mean),
                  high = with(Compounding::maximum);
  for (int y = 0; y < scene.plane.height; ++y) {
    for (int x = 0; x < scene.plane.width; ++x) {
      ASSERT_LE(low.pixels.view()(x, y), mean.pixels.view()(x, y));
      ASSERT_LE(mean.pixels.view()(x, y), high.pixels.view()(x, y));
    }
  }
}

TEST_P(Laws, ZeroThicknessIsTheThinReslice) {
  test::RandomScene scene = test::random_scene(GetParam());
  scene.settings.band.thickness_mm = 0;
  scene.settings.compounding = Compounding::maximum;
  const BandImage thin = render(scene);
  for (const auto how : {Compounding::minimum, Compounding::mean}) {
    scene.settings.compounding = how;
    if (thin.kind == PixelKind::doppler && how == Compounding::mean) continue;  // level 0 means to grey
    EXPECT_TRUE(test::same_bits(thin, render(scene)));
  }
}

TEST_P(Laws, OrderOfFramesDoesNotMatter) {
  Serial serial;
  test::RandomScene scene = test::random_scene(GetParam());
  std::vector<int> order(scene.sweep.frames().size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    scene.settings.interpolation = interpolation;
    const BandImage image = render(scene);
    std::shuffle(order.begin(), order.end(), std::mt19937(GetParam()));
    EXPECT_TRUE(
        test::same_bits(image, render_planar(scene.sweep.view(order), scene.plane, scene.settings, serial)));
  }
}

TEST_P(Laws, SameBitsForAnyNumberOfThreads) {
  test::RandomScene scene = test::random_scene(GetParam());
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    scene.settings.interpolation = interpolation;
    const BandImage one = render(scene);
    for (const int threads : {2, 3, 7}) {
      Threads parallel(threads);
      EXPECT_TRUE(
          test::same_bits(one, render_planar(scene.sweep.view(), scene.plane, scene.settings, parallel)));
    }
  }
}

TEST_P(Laws, LinesOfAPlaneArePaintedAsThePlane) {
  test::RandomScene scene = test::random_scene(GetParam());
  Serial serial;
  for (const auto interpolation : {Interpolation::nearest, Interpolation::linear}) {
    scene.settings.interpolation = interpolation;
    const BandImage planar = render(scene);
    const BandImage lines = render_lines(scene.sweep.view(), plane_lines(scene.plane, scene.settings.band),
                                         scene.settings, serial);
    EXPECT_TRUE(test::same_bits(planar, lines));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Laws, testing::Range(1000U, 1012U));

TEST(LineBundle, CurvedLinesAndMissingOnesEqualReference) {
  for (unsigned seed = 2000; seed < 2012; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    LineBundle bundle = plane_lines(scene.plane, scene.settings.band);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> bend(-0.3, 0.3);
    for (auto& start : bundle.starts) start.v += Eigen::Vector3d(bend(random), bend(random), bend(random));
    bundle.present.assign(bundle.starts.size(), 1);
    for (auto& p : bundle.present) p = random() % 5 == 0 ? 0 : 1;
    Serial serial;
    const BandImage image = render_lines(scene.sweep.view(), bundle, scene.settings, serial);
    const BandImage truth = test::reference_lines(scene.sweep.view(), bundle, scene.settings);
    EXPECT_GE(test::compare(image, truth).equal_share(), 0.995) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sonoband
