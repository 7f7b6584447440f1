#include "app/exchange/plus_config.h"

#include <gtest/gtest.h>

#include "tests/app/exchange/sequence_samples.h"
#include "tests/support/support.h"

namespace sonoband::test {
namespace {

using exchange::ClipRectangle;
using exchange::Fan;
using exchange::parse_plus_config;
using exchange::sector_mask;

const std::string identity = "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1";

std::string refused(const std::string& xml) {
  return refusal([&] { parse_plus_config(xml, "plus.xml"); });
}

TEST(PlusConfig, TakesEveryTransformOfCoordinateDefinitionsWhereverItStands) {
  const auto config = parse_plus_config(
      "<A>\n<B><CoordinateDefinitions>\n"
      "<Transform From='Image' To='Probe'\n Matrix='\n0.1\t0 0 5\n 0 -6.68987e-005 0 6\n 0 0 0.1 7\n 0 0 0 "
      "1'\n"
      " Error='1.6' Date='today'/>\n"
      "<Transform From='Phantom' To='Reference' Matrix='" +
          identity +
          "'/>\n"
          "</CoordinateDefinitions></B>\n<Transform Name='ProbeToTracker'/></A>",
      "plus.xml");
  ASSERT_EQ(config.transforms.size(), 2u);
  EXPECT_EQ(config.transforms[0].name, (exchange::TransformName{"Image", "Probe"}));
  EXPECT_EQ(config.transforms[0].to_from_from(0, 3), 5);
  EXPECT_EQ(config.transforms[0].to_from_from(1, 1), -6.68987e-5);
  EXPECT_EQ(config.transforms[0].error, "1.6");
  EXPECT_EQ(config.transforms[0].place, "plus.xml, line 3");
}

TEST(PlusConfig, TakesTheTransformOfCalibrationResults) {
  const auto config = parse_plus_config("<R><CalibrationResults><Transform From='Image' To='Probe' Matrix='" +
                                            identity + "'/></CalibrationResults></R>",
                                        "plus.xml");
  EXPECT_EQ(config.transforms.size(), 1u);
}

TEST(PlusConfig, ClipAndFanAreThoseOfTheVolumeReconstruction) {
  const auto config = parse_plus_config(
      "<P><Segmentation ClipRectangleOrigin='27 27' ClipRectangleSize='766 562'/>"
      "<DataSource ClipRectangleOrigin='1 1' ClipRectangleSize='2 2'/>"
      "<VolumeReconstruction ClipRectangleOrigin='192 16' ClipRectangleSize='420 580' FanOriginPixel='380 20'"
      " FanAnglesDeg='45 -45' FanRadiusStartPixel='120' FanRadiusStopPixel='360'/></P>",
      "plus.xml");
  ASSERT_TRUE(config.clip);
  EXPECT_EQ(config.clip->x, 192);
  EXPECT_EQ(config.clip->height, 580);
  ASSERT_TRUE(config.fan);
  EXPECT_EQ(config.fan->from_deg, -45);
  EXPECT_EQ(config.fan->to_deg, 45);
  EXPECT_EQ(config.fan->start_px, 120);
  EXPECT_TRUE(config.warnings.empty());
}

TEST(PlusConfig, OldNamesAndMissingRadiusAreTaken) {
  const auto config = parse_plus_config(
      "<VolumeReconstruction FanOrigin='10 0' FanAngles='-30 30' FanDepth='77'/>", "plus.xml");
  ASSERT_TRUE(config.fan);
  EXPECT_EQ(config.fan->stop_px, 77);
  const auto no_stop = parse_plus_config("<VolumeReconstruction FanAnglesDeg='-30 30'/>", "plus.xml");
  EXPECT_EQ(no_stop.fan->stop_px, 500);
  EXPECT_EQ(no_stop.warnings.size(), 1u);
}

TEST(PlusConfig, NoAnglesNoFanAndNoSizeNoClip) {
  const auto config = parse_plus_config(
      "<VolumeReconstruction ClipRectangleOrigin='0 0' ClipRectangleSize='0 0' FanAnglesDeg='0 0'"
      " FanOriginPixel='1 2'/>",
      "plus.xml");
  EXPECT_FALSE(config.clip);
  EXPECT_FALSE(config.fan);
}

TEST(PlusConfigDamage, EachKindHasItsSentenceAndLine) {
  const auto defined = [](const std::string& transform) {
    return "<P>\n<CoordinateDefinitions>\n" + transform + "\n</CoordinateDefinitions></P>";
  };
  EXPECT_SAYS(refused("<P>\n<Q>\n</P>"), "plus.xml, line 3: this is no XML");
  EXPECT_SAYS(refused(""), "this is no XML");
  EXPECT_SAYS(refused(defined("<Transform From='Image' To='Probe'/>")), "plus.xml, line 3: a Transform");
  EXPECT_SAYS(refused(defined("<Transform From='A' To='A' Matrix='" + identity + "'/>")),
              "two different frames");
  EXPECT_SAYS(refused(defined("<Transform From='Image' To='Probe' Matrix='1 0 0'/>")),
              "plus.xml, line 3, Matrix of Image to Probe: '1 0 0' is not the 16 numbers");
  EXPECT_SAYS(refused("<VolumeReconstruction ClipRectangleOrigin='0 0'/>"), "belong together");
  EXPECT_SAYS(refused("<VolumeReconstruction ClipRectangleOrigin='0 0' ClipRectangleSize='5 -5'/>"),
              "at least 1 pixel");
  EXPECT_SAYS(refused("<VolumeReconstruction ClipRectangleOrigin='0' ClipRectangleSize='5 5'/>"),
              "must be 2 numbers");
  EXPECT_SAYS(refused("<VolumeReconstruction FanAnglesDeg='-100 30'/>"), "between -90 and 90");
  EXPECT_SAYS(
      refused("<VolumeReconstruction FanAnglesDeg='-30 30' FanRadiusStartPixel='9' FanRadiusStopPixel='5'/>"),
      "must be more than");
  EXPECT_SAYS(refusal([] { exchange::read_plus_config("/nowhere/plus.xml"); }), "cannot be opened");
}

TEST(SectorMask, NothingGivenIsEmpty) {
  EXPECT_TRUE(sector_mask(8, 8, std::nullopt, std::nullopt, std::nullopt, "x").view().empty());
}

TEST(SectorMask, RectanglesIntersect) {
  const auto mask =
      sector_mask(10, 10, ClipRectangle{2, 3, 5, 100}, ClipRectangle{-4, 0, 9, 5}, std::nullopt, "x");
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x)
      EXPECT_EQ(mask.view()(x, y) != 0, x >= 2 && x < 5 && y >= 3 && y < 5) << x << ' ' << y;
}

TEST(SectorMask, AFanOpensDownwards) {
  const Fan fan{.origin_px = {50, 10}, .from_deg = -45, .to_deg = 30, .start_px = 20, .stop_px = 60};
  const auto mask = sector_mask(101, 101, std::nullopt, std::nullopt, fan, "x");
  const auto in = [&](int x, int y) { return mask.view()(x, y) != 0; };
  EXPECT_TRUE(in(50, 30));   // straight down, at the near arc
  EXPECT_FALSE(in(50, 29));  // nearer
  EXPECT_TRUE(in(50, 70));   // at the far arc
  EXPECT_FALSE(in(50, 71));
  EXPECT_TRUE(in(20, 40));  // on the ray at -45 degrees
  EXPECT_FALSE(in(19, 40));
  EXPECT_TRUE(in(67, 40));  // tan 30 x 30 = 17.3
  EXPECT_FALSE(in(68, 40));
  EXPECT_FALSE(in(50, 5));  // above the apex
}

TEST(SectorMask, NothingLeftIsRefused) {
  EXPECT_SAYS(refusal([] {
                sector_mask(10, 10, ClipRectangle{20, 0, 5, 5}, std::nullopt, std::nullopt, "sweep.mha");
              }),
              "sweep.mha: clip rectangle and fan leave no pixel");
}

}  // namespace
}  // namespace sonoband::test
