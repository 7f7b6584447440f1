// The ordered key obeys the paper's rules for "brighter", and colours survive the way from the screen and
// back.
#include <gtest/gtest.h>

#include "core/image/colour_bar.h"
#include "core/image/overlay.h"

namespace sonoband::doppler {
namespace {

TEST(DopplerKey, AnyColourBeatsAnyGreyAndRedBeatsBlueOfTheSameLevel) {
  EXPECT_GT(colour_key(0, false), grey_key(127));
  for (int level = 0; level < level_count; ++level) {
    EXPECT_GT(colour_key(level, true), colour_key(level, false));
    if (level > 0) {
      EXPECT_GT(colour_key(level, false), colour_key(level - 1, true));
    }
    EXPECT_EQ(velocity(colour_key(level, true)), level);
    EXPECT_EQ(velocity(colour_key(level, false)), -level);
  }
  EXPECT_EQ(velocity(grey_key(127)), 0);
}

TEST(ColourBar, ClassifierInvertsTheBarWithinFourLevels) {
  const ColourBar bar = red_blue_bar();
  const ColourClassifier classifier(bar, {});
  for (int key = 128; key < 256; ++key) {
    const auto pixel = classifier.classify(to_rgb(static_cast<std::uint8_t>(key), bar));
    ASSERT_TRUE(pixel.known) << key;
    EXPECT_NEAR(velocity(pixel.key), velocity(static_cast<std::uint8_t>(key)), 4) << key;
  }
}

// Red to white and green: another maker's bar. Nothing of the usual one is left in it.
TEST(ColourBar, RampsOfAnyColoursAreBarsLikeTheUsualOne) {
  const std::array<Rgb, 3> towards = {{{64, 0, 0}, {255, 0, 0}, {255, 255, 255}}};
  const std::array<Rgb, 2> away = {{{0, 60, 0}, {0, 255, 128}}};
  const ColourBar bar{ramp(towards), ramp(away)};
  EXPECT_EQ(bar.red.front(), towards[0]);
  EXPECT_EQ(bar.red.back(), towards[2]);
  EXPECT_NEAR(bar.red[31].r, 252, 1);  // 31/63 of the way: 62/63 of the first half
  EXPECT_EQ(bar.red[31].g, 0);
  EXPECT_EQ(bar.blue.back(), away[1]);
  const ColourClassifier classifier(bar, {});
  for (int level = 8; level < 40; ++level) {
    EXPECT_NEAR(velocity(classifier.classify(bar.red[level]).key), level, 4) << level;
    EXPECT_NEAR(velocity(classifier.classify(bar.blue[level]).key), -level, 6) << level;
  }
  EXPECT_FALSE(classifier.classify({0, 64, 255}).known) << "blue is not on this bar";
}

TEST(ColourBar, GreyGoesThereAndBackExactly) {
  const ColourBar bar = red_blue_bar();
  const ColourClassifier classifier(bar, {});
  for (int grey = 0; grey < 128; ++grey) {
    const auto pixel = classifier.classify(to_rgb(grey_key(grey), bar));
    EXPECT_TRUE(pixel.known);
    EXPECT_EQ(pixel.key, grey);
  }
}

TEST(ColourBar, HuesThatAreNotOnTheBarAreUnknown) {
  const ColourClassifier classifier(red_blue_bar(), {});
  EXPECT_FALSE(classifier.classify({40, 220, 40}).known);   // turbulence green
  EXPECT_FALSE(classifier.classify({220, 40, 220}).known);  // magenta
}

TEST(ColourBar, OutsideTheSectorNothingCounts) {
  const ColourClassifier classifier(red_blue_bar(), {});
  const std::uint8_t rgb[] = {255, 0, 0, 255, 0, 0};
  Pixels sector(2, 1);
  sector.view()(1, 0) = 255;
  Pixels keys(2, 1);
  Pixels valid(2, 1);
  classifier.classify(rgb, 6, sector.view(), keys.view(), valid.view());
  EXPECT_EQ(keys.view()(0, 0), 0);
  EXPECT_EQ(valid.view()(0, 0), 0);
  EXPECT_TRUE(is_colour(keys.view()(1, 0)));
  EXPECT_EQ(valid.view()(1, 0), 255);
}

// Speckle that changes from frame to frame, dark fluid that does not, and a white line.
Pixels scanner_picture(int frame) {
  Pixels picture(8, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x)
      picture.view()(x, y) = static_cast<std::uint8_t>(60 + (frame * 37 + x * 11 + y * 5) % 140);
    picture.view()(0, y) = 3;
    picture.view()(4, y) = static_cast<std::uint8_t>(240 + frame % 3);
  }
  return picture;
}

TEST(Overlay, TheWhiteBoxIsMaskedAndDarkFluidIsNot) {
  OverlayDetector detector(8, 4);
  for (int frame = 0; frame < 20; ++frame) detector.add(scanner_picture(frame).view());
  const Pixels mask = detector.mask({}, true);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(mask.view()(x, 2), x >= 3 && x <= 5 ? 0 : 255) << x;
}

TEST(Overlay, AStillProbeHasNoOverlay) {
  OverlayDetector detector(8, 4);
  for (int frame = 0; frame < 20; ++frame) detector.add(scanner_picture(0).view());
  EXPECT_EQ(detector.mask({}, false).view()(4, 2), 255);
}

}  // namespace
}  // namespace sonoband::doppler
