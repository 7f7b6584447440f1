// A scanner that shows colour Doppler, from its video to the band, the exam and back.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/image/doppler.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

struct Flow {
  double red = 0, blue = 0, grey = 0, white = 0;
};

Flow flow_in(const ui::Picture& picture) {
  Flow flow;
  for (int y = 0; y < picture.pixels.height; ++y) {
    for (int x = 0; x < picture.pixels.width; ++x) {
      if (!picture.coverage.empty() && picture.coverage(x, y) == 0) continue;
      const std::uint8_t key = picture.pixels(x, y);
      if (doppler::is_colour(key))
        ++(doppler::velocity(key) < 0 ? flow.blue : flow.red);
      else
        ++(key == 127 ? flow.white : flow.grey);
    }
  }
  return flow;
}

// The vessels' artery flows one way and the vein the other; the scanner draws a white box round them, which a
// maximum of 14 mm would show as a wall.
TEST(Doppler, FlowsFromTheVideoToTheBandWithoutTheScannersBoxAndBackOutOfTheExam) {
  ScreenCartSettings settings;
  settings.doppler = true;
  settings.exams = scratch_folder() / "exams";
  Flow recorded;
  {
    ScreenCart cart(settings);
    const ui::View& view = cart.loop().view();
    cart.play("await live 5\nwait 1\n");
    EXPECT_EQ(view.live.picture.kind, PixelKind::doppler);
    cart.play("press\nwait 3\n");
    EXPECT_GT(flow_in(view.live.growing).red, 100) << "while it grows";
    cart.play("release\nawait review 5\nwait 0.3\n");
    EXPECT_EQ(view.review.band.kind, PixelKind::doppler);
    EXPECT_TRUE(view.review.has_doppler);
    recorded = flow_in(view.review.band);
    EXPECT_GT(recorded.red, 1000);
    EXPECT_GT(recorded.blue, 1000);
    EXPECT_GT(recorded.grey, 1000);
    EXPECT_EQ(recorded.white, 0);
    ASSERT_TRUE(until(
        cart, [&] { return cart.cart().exams()->status().state == exam::RecorderStatus::State::saved; }));
  }
  ScreenCart again(settings);
  const ui::View& view = again.loop().view();
  again.play("tap rail/exams\n");
  ASSERT_TRUE(until(again, [&] { return again.has("exams/0"); }));
  again.play("double-tap exams/0\n");
  ASSERT_TRUE(until(again, [&] { return !view.review.frames.empty() && view.review.band.version != 0; }));
  again.play("wait 1\n");
  const Flow opened = flow_in(view.review.band);
  // The window has another shape, and so samples lie elsewhere.
  EXPECT_NEAR(opened.red, recorded.red, 0.005 * recorded.red);
  EXPECT_NEAR(opened.blue, recorded.blue, 0.005 * recorded.blue);
  EXPECT_NEAR(opened.grey, recorded.grey, 0.005 * recorded.grey);
  EXPECT_EQ(opened.white, 0);
}

}  // namespace
}  // namespace sonoband::test
