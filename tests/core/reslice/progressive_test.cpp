// Coarse first, full after, cancelled at any strip; never coarser than asked without a budget.
#include "core/reslice/progressive.h"

#include <gtest/gtest.h>

#include "tests/core/reslice/compare.h"
#include "tests/core/reslice/random_geometry.h"

namespace sonoband {
namespace {

struct Shown {
  BandImage image;
  int factor = 0;
  int strips_before = 0;  // of the full picture, that were painted by then
};

// A picture of several strips: four across and three down.
test::RandomScene wide_scene(unsigned seed) {
  test::RandomScene scene = test::random_scene(seed);
  scene.plane.width = 900;
  scene.plane.height = 150;
  scene.plane.pixel_mm /= 8;
  scene.settings.band.thickness_mm = 8.4 * scene.settings.band.step_mm;
  return scene;
}

// Shows what comes when the budget lasts for so many strips of the full picture.
std::vector<Shown> render_for(const test::RandomScene& scene, int strips, int factor, Parallel& parallel) {
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  std::vector<Shown> shown;
  int asked = 0;
  render_progressively(sweep, scene.plane, scene.settings, {factor, [&] { return asked++ >= strips; }},
                       parallel, nullptr, [&](BandImage image, int f) {
                         shown.push_back({std::move(image), f, asked - 1});
                       });
  return shown;
}

BandImage whole(const test::RandomScene& scene) {
  Serial serial;
  return render_planar(scene.sweep.view(), scene.plane, scene.settings, serial);
}

TEST(Progressive, TheCoarsePictureIsTheViewAtEveryFactorthPixelAndLayer) {
  for (unsigned seed = 3020; seed < 3026; ++seed) {
    test::RandomScene scene = wide_scene(seed);
    Serial serial;
    const std::vector<Shown> shown = render_for(scene, 0, 3, serial);
    ASSERT_EQ(shown.size(), 2U);
    EXPECT_EQ(shown[0].factor, 3);
    EXPECT_EQ(shown[0].strips_before, 0);
    RenderSettings every_third = scene.settings;
    every_third.band = {6 * scene.settings.band.step_mm, 3 * scene.settings.band.step_mm};
    ReslicePlane plane = scene.plane;
    plane.width = 300;
    plane.height = 50;
    plane.pixel_mm *= 3;
    EXPECT_TRUE(
        test::same_bits(shown[0].image, render_planar(scene.sweep.view(), plane, every_third, serial)));
    EXPECT_EQ(shown[1].factor, 1);
    EXPECT_TRUE(test::same_bits(shown[1].image, whole(scene))) << "a strip was left out or painted twice";
  }
}

TEST(Progressive, ThinCoarsePixelsAreThoseOfTheFullPicture) {
  for (unsigned seed = 3030; seed < 3036; ++seed) {
    test::RandomScene scene = test::random_scene(seed);
    scene.settings.band.thickness_mm = 0;
    Serial serial;
    const std::vector<Shown> shown = render_for(scene, 0, 3, serial);
    ASSERT_EQ(shown.size(), 2U);
    const BandImage& coarse = shown[0].image;
    int unequal = 0, pixels = 0;
    for (int y = 0; y < coarse.pixels.height(); ++y) {
      for (int x = 0; x < coarse.pixels.width(); ++x, ++pixels)
        unequal += coarse.pixels.view()(x, y) != shown[1].image.pixels.view()(3 * x, 3 * y) ? 1 : 0;
    }
    EXPECT_LE(unequal, 1 + pixels / 200) << "seed " << seed;
  }
}

TEST(Progressive, TheCoarsePictureIsShownWhenTheBudgetIsSpentAndNotAtAllWhereItSuffices) {
  test::RandomScene scene = wide_scene(3040);
  Serial serial;
  constexpr int strips = 12;
  for (const int lasts : {1, 5, strips - 1}) {
    const std::vector<Shown> shown = render_for(scene, lasts, 2, serial);
    ASSERT_EQ(shown.size(), 2U) << lasts;
    EXPECT_EQ(shown[0].factor, 2);
    EXPECT_EQ(shown[0].strips_before, lasts);
    EXPECT_TRUE(test::same_bits(shown[1].image, whole(scene))) << lasts;
  }
  const std::vector<Shown> shown = render_for(scene, strips, 2, serial);
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].factor, 1);
  EXPECT_TRUE(test::same_bits(shown[0].image, whole(scene)));
}

TEST(Progressive, WithoutAFactorThereIsOnlyTheFullPicture) {
  test::RandomScene scene = wide_scene(3041);
  Serial serial;
  const std::vector<Shown> shown = render_for(scene, 0, 1, serial);
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].factor, 1);
}

// A picture of other pixels thins the sweep otherwise.
TEST(Progressive, WhatIsShownMeanwhileMayBePaintedFromTheSameSweep) {
  test::RandomScene scene = wide_scene(3043);
  scene.settings.thin_dense_frames = true;
  Serial serial;
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  BandImage last;
  render_progressively(sweep, scene.plane, scene.settings, {}, serial, nullptr, [&](BandImage image, int) {
    last = std::move(image);
    ReslicePlane other = scene.plane;
    other.pixel_mm *= 7;
    render_planar(sweep, other, scene.settings, serial);
  });
  EXPECT_TRUE(test::same_bits(last, whole(scene)));
}

// Counts bodies, and sets a flag with the last of some.
class Stopping final : public Parallel {
 public:
  Stopping(int last, StopFlag& stop) : last_(last), stop_(stop) {}
  int width() const override { return 1; }
  void for_each(int count, const std::function<void(int)>& body) override {
    for (int i = 0; i < count; ++i) {
      body(i);
      if (++bodies_ == last_) stop_ = true;
    }
  }

 private:
  int last_;
  int bodies_ = 0;
  StopFlag& stop_;
};

TEST(Progressive, NothingIsShownOnceItIsStopped) {
  test::RandomScene scene = wide_scene(3042);
  PreparedSweep sweep(scene.sweep.view(), scene.settings.gap);
  // The coarse picture has 2 x 2 strips; then come the full one's 12, in two goes of 12 and what is left.
  constexpr int coarse = 4, before_pause = 12;
  const auto shown_when_stopped_at = [&](int body) {
    std::vector<int> factors;
    StopFlag stop{false};
    Stopping parallel(body, stop);
    render_progressively(sweep, scene.plane, scene.settings, {}, parallel, &stop,
                         [&](const BandImage&, int factor) { factors.push_back(factor); });
    return factors;
  };
  EXPECT_EQ(shown_when_stopped_at(1), std::vector<int>{});
  EXPECT_EQ(shown_when_stopped_at(coarse), std::vector<int>{});
  EXPECT_EQ(shown_when_stopped_at(coarse + before_pause + 3), std::vector<int>{2});
  EXPECT_EQ(shown_when_stopped_at(coarse + before_pause + 12), std::vector<int>{2});
  EXPECT_EQ(shown_when_stopped_at(1000), (std::vector<int>{2, 1}));
}

}  // namespace
}  // namespace sonoband
