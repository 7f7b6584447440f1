#include "app/exchange/markups.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

using exam::ReviewKind;

exam::ReviewObject object(const std::string& name, ReviewKind kind, const std::string& json) {
  return {.object = name, .kind = kind, .json = json, .png = {}};
}

TEST(Markups, LandmarksContoursAndDistancesAreWhatSlicerReads) {
  const auto json = nlohmann::json::parse(slicer_markups(
      {object("a", ReviewKind::landmark, R"({"label":"apex","position_mm":[1.5,-2,3]})"),
       object("n", ReviewKind::note, R"({"text":"passed over"})"),
       object("c", ReviewKind::contour, R"({"label":"outline","points_mm":[[0,0,0],[1,0,0],[0,1,0]]})"),
       object("o", ReviewKind::contour, R"({"closed":false,"points_mm":[[0,0,0],[1,0,0]]})"),
       object("d", ReviewKind::measurement, R"({"label":"BPD","points_mm":[[0,0,0],[0,0,48.2]]})"),
       object("b", ReviewKind::landmark, R"({"position_mm":[4,5,6]})")}));
  EXPECT_NE(json.at("@schema").get<std::string>().find("markups-schema-v1.0.3"), std::string::npos);
  const auto& markups = json.at("markups");
  ASSERT_EQ(markups.size(), 4u);
  EXPECT_EQ(markups[0].at("type"), "Fiducial");
  EXPECT_EQ(markups[0].at("coordinateSystem"), "RAS");
  ASSERT_EQ(markups[0].at("controlPoints").size(), 2u);
  EXPECT_EQ(markups[0]["controlPoints"][0].at("label"), "apex");
  EXPECT_EQ(markups[0]["controlPoints"][0].at("position"), nlohmann::json({1.5, -2, 3}));
  EXPECT_EQ(markups[0]["controlPoints"][1].at("label"), "b");
  EXPECT_EQ(markups[1].at("type"), "ClosedCurve");
  EXPECT_EQ(markups[1].at("controlPoints").size(), 3u);
  EXPECT_EQ(markups[2].at("type"), "Curve");
  EXPECT_EQ(markups[3].at("type"), "Line");
  EXPECT_EQ(markups[3].at("name"), "BPD");
  EXPECT_EQ(markups[3]["controlPoints"][1].at("position"), nlohmann::json({0, 0, 48.2}));
}

TEST(Markups, NothingGivesNothing) {
  EXPECT_EQ(slicer_markups({}), "");
  EXPECT_EQ(slicer_markups({object("n", ReviewKind::note, "{}")}), "");
}

TEST(Markups, WhatCannotBeAPlaceIsNamed) {
  for (const char* bad : {"no json", "[]", "{}", R"({"position_mm":[1,2]})", R"({"position_mm":[1,2,"x"]})",
                          R"({"position_mm":[1,2,null]})", R"({"label":3,"position_mm":[1,2,3]})"}) {
    try {
      slicer_markups({object("here", ReviewKind::landmark, bad)});
      ADD_FAILURE() << "taken: " << bad;
    } catch (const BadInput& e) {
      EXPECT_NE(std::string(e.what()).find("review object here"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace sonoband::exchange
