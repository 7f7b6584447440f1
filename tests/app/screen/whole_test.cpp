// A finger and a foot drive the whole application: from boot to a second sweep, at every size and scale, each
// state against its golden picture.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/app/screen/golden.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

struct Look {
  int width, height;
  float scale;
  const char* name;
};

class Whole : public ::testing::TestWithParam<Look> {};

TEST_P(Whole, FromBootToASecondSweep) {
  const Look look = GetParam();
  ScreenCartSettings settings;
  settings.screen.width = look.width;
  settings.screen.height = look.height;
  settings.screen.scale = look.scale;
  settings.screen.shots = scratch_folder();
  settings.pixels = true;
  ScreenCart cart(settings);
  const auto golden = [&](const std::string& state) { expect_golden(cart, state + look.name); };

  cart.play("await live 5\nwait 1.5\n");
  golden("live");
  cart.play("press\nwait 1.5\n");
  golden("recording");
  cart.play("wait 1.2\nrelease\nawait review 5\nwait 0.2\n");
  const auto& session = cart.loop().session();
  EXPECT_EQ(session.page(), ui::Page::review);
  EXPECT_EQ(session.sweep_count(), 1u);
  golden("review");

  const bool every_step = std::string_view(look.name).empty();  // the others are for what it looks like
  // A thinner band: the gestures are what counts now, and every step of them is rendered.
  cart.play("drag tools/thickness 0.7,0.5 0.2,0.5 0.1\n");
  if (every_step) {
    cart.play(R"(tap tools/mean
drag reslice/picture 0.5,0.5 0.55,0.56 0.1
pinch reslice/picture 1.3
twist reslice/picture 12
drag reslice/normal 0.5,0.5 0.5,0.55 0.1
)");
    golden("moved");
    cart.play("tap tools/reset\ntap tools/maximum\n");
  }
  cart.play(R"(tap tools/curve
drag reslice/picture 0.42,0.6 0.46,0.45 0.54,0.45 0.58,0.6 0.3
drag tools/thickness 0.2,0.5 0.36,0.5 0.1
drag manifold/reach 0.5,0.5 0.5,1.1 0.1
)");
  ASSERT_TRUE(cart.loop().worker().newest()->manifold);
  golden("manifold");
  if (!every_step) {
    cart.play("tap rail/set-up\n");
    golden("set-up");
    return;
  }
  cart.play(R"(tap tools/mark
tap review/picture
tap tools/measure
drag review/slider 0.5,0.5 0.4,0.5 0.1
tap review/picture
tap reslice/picture
drag outline/picture 0.5,0.5 0.6,0.45 0.1
)");
  golden("measured");
  cart.play(R"(tap measure/clear
tap tools/contour
drag review/picture 0.42,0.45 0.58,0.45 0.58,0.6 0.42,0.6 0.42,0.46 0.5
drag reslice/picture 0.4,0.4 0.6,0.36 0.62,0.6 0.42,0.64 0.4,0.42 0.5
)");
  const auto contours = cart.loop().view().review.contours;
  ASSERT_EQ(contours.size(), 2u);
  EXPECT_GE(contours[0].frame, 0);
  EXPECT_TRUE(contours[1].on_plane);
  golden("contoured");
  cart.play("hold reslice/picture 0.8\n");
  EXPECT_EQ(cart.loop().view().review.contours.size(), 1u) << "the finger rested inside it";
  cart.play("tap contour/clear\n");
  EXPECT_TRUE(cart.loop().view().review.contours.empty());
  cart.play("tap rail/snapshot\n");
  EXPECT_TRUE(std::filesystem::exists(settings.screen.shots / "snapshot-1.png"));
  cart.play("tap rail/live\nwait 0.2\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\n");
  EXPECT_EQ(session.sweep_count(), 2u);
  EXPECT_EQ(session.page(), ui::Page::review);
  cart.play("tap rail/set-up\n");
  golden("set-up");
}

INSTANTIATE_TEST_SUITE_P(Screens, Whole,
                         ::testing::Values(Look{1280, 800, 1, ""}, Look{1280, 800, 1.5f, "-large"},
                                           Look{1920, 1080, 1, "-hd"}, Look{1920, 1080, 1.5f, "-hd-large"}),
                         [](const auto& chosen) {
                           std::string name = chosen.param.name;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return "Screen" + name;
                         });

}  // namespace
}  // namespace sonoband::test
