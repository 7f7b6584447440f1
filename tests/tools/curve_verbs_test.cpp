// flow and manifold on curves and a recording whose answers are known.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/exchange/png.h"
#include "app/exchange/sequence_file.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class CurveVerbs : public ToolTest {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(path(name)) << text; }
  Json read(const std::string& name) {
    std::ifstream file(path(name));
    return Json::parse(file);
  }
  ToolRun flow(const std::string& method, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"flow",     "--curve", path("curve.csv"), "--step-mm", "0.5",
                                   "--layers", "8",       "--method",        method,      "--smooth-px",
                                   "0",        "--out",   path("flow.json")};
    words.insert(words.end(), more.begin(), more.end());
    return run_tool(words);
  }

  // 30 frames of 60 x 40 pixels of 0.5 mm, 0.5 mm apart along z; grey is a function of x, y, z.
  void write_recording() {
    exchange::TrackedSequence s;
    s.width = 60;
    s.height = 40;
    s.frames.resize(30);
    s.pixels = exchange::PixelBuffer(60 * 40 * 30);
    for (int i = 0; i < 30; ++i) {
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose(0, 0) = pose(1, 1) = pose(2, 2) = 0.5;
      pose(2, 3) = 0.5 * i;
      exchange::set_transform(s.frames[static_cast<std::size_t>(i)], {"Image", "Reference"}, pose);
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x)
          s.pixels.bytes()[(static_cast<std::size_t>(i) * 40 + static_cast<std::size_t>(y)) * 60 +
                           static_cast<std::size_t>(x)] =
              static_cast<std::uint8_t>((x * 37 + y * 91 + i * 53 + x * y) % 251);
    }
    exchange::write_sequence(s, path("sweep.mha"));
  }
  // x right, y down through the middle frame: n is along the sweep.
  std::vector<std::string> manifold(std::vector<std::string> more) {
    std::vector<std::string> words{"manifold", path("sweep.mha"), "--origin", "0,0,7", "--right",    "1,0,0",
                                   "--down",   "0,1,0",           "--size",   "60x40", "--pixel-mm", "0.5",
                                   "--out",    path("band.png")};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(CurveVerbs, FlowOfAVHasItsShockOnTheBisector) {
  write("curve.csv", "x,y\n20, 20\n0,0\n\n# the second arm\n20,-20\n");
  for (const char* method : {"exact", "route-map"}) {
    const ToolRun run = flow(method);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Json json = read("flow.json");
    // Two arms of 28.28 mm: round(113.1) + 1 rulings.
    ASSERT_EQ(json["rulings"].size(), 114u);
    ASSERT_EQ(json["layers"].size(), 17u);
    EXPECT_EQ(json["layers"][0]["k"], -8);
    EXPECT_EQ(json["layers"][16]["k"], 8);
    EXPECT_EQ(json["layers"][8]["feet"], json["rulings"]);
    int smeared = 0;
    for (const Json& foot : json["layers"][16]["feet"]) {
      ASSERT_EQ(foot.size(), 2u);
      smeared += std::hypot(foot[0].get<double>() - 4 / std::sin(M_PI / 4), foot[1].get<double>()) < 1e-6;
    }
    EXPECT_NEAR(smeared, 2 * 8, 1);
    EXPECT_GE(json["layers"][16]["front"].size(), 1u);
  }
}

// The naive front keeps every ruling's own normal: on the inside of a corner they have crossed, none are one.
TEST_F(CurveVerbs, NaiveFlowOfAVDoesNotSmear) {
  write("curve.csv", "20,20\n0,0\n20,-20\n");
  ASSERT_EQ(flow("naive").exit_code, 0);
  const Json feet = read("flow.json")["layers"][16]["feet"];
  ASSERT_EQ(feet.size(), 114u);
  for (std::size_t i = 1; i < feet.size(); ++i) {
    const double dx = feet[i][0].get<double>() - feet[i - 1][0].get<double>();
    const double dy = feet[i][1].get<double>() - feet[i - 1][1].get<double>();
    EXPECT_GT(std::hypot(dx, dy), 0.4) << i;
  }
}

TEST_F(CurveVerbs, FlowOfAClosedCurveVanishesInside) {
  std::string ring;
  for (int i = 0; i <= 90; ++i) {
    const double a = (i % 90) * M_PI / 45;
    ring += std::to_string(3 * std::cos(a)) + "," + std::to_string(3 * std::sin(a)) + "\n";
  }
  write("curve.csv", ring);
  ASSERT_EQ(flow("exact").exit_code, 0);
  const Json json = read("flow.json");
  // Radius 3 mm is six steps: layer 7 has nothing inside.
  EXPECT_TRUE(json["layers"][15]["front"].empty());
  for (const Json& foot : json["layers"][15]["feet"]) EXPECT_TRUE(foot.is_null());
  for (const Json& foot : json["layers"][1]["feet"]) EXPECT_FALSE(foot.is_null());
}

TEST_F(CurveVerbs, FlowSaysWhatIsWrongWithAFile) {
  const auto says = [&](const std::string& text, const std::string& part) {
    write("curve.csv", text);
    const ToolRun run = flow("exact");
    EXPECT_EQ(run.exit_code, 1) << text;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  };
  says("0,0\n1;2\n", "curve.csv:2: '1;2' is not x,y");
  says("0,0\nnan,2\n", "curve.csv:2:");
  says("0,0\n1,2,3\n", "curve.csv:2:");
  says("", "no points");
  says("1,1\n1,1\n", "one place");
  says("0,0\n1e9,0\n", "longer than");
  EXPECT_EQ(
      run_tool({"flow", "--curve", path("none.csv"), "--step-mm", "1", "--layers", "2", "--out", path("o")})
          .exit_code,
      1);
  write("curve.csv", "0,0\n9,0\n");
  EXPECT_EQ(flow("fast").exit_code, 2);
  EXPECT_EQ(flow("exact", {"--layers", "-1"}).exit_code, 2);
}

TEST_F(CurveVerbs, StraightManifoldIsRenderToTheLastPixel) {
  write_recording();
  const ToolRun run = run_tool(manifold({"--curve", "5,4 20,4", "--reach-mm", "6", "--thickness-mm", "3",
                                         "--smear", path("smear.png"), "--json", path("band.json")}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Its rows go along x, its columns along z from 7 - 6 mm.
  ASSERT_EQ(
      run_tool({"render", path("sweep.mha"), "--origin", "5,4,1", "--right", "0,0,1", "--down", "1,0,0",
                "--size", "25x31", "--pixel-mm", "0.5", "--thickness-mm", "3", "--out", path("plane.png")})
          .exit_code,
      0);
  const auto band = exchange::read_png(path("band.png")), plane = exchange::read_png(path("plane.png"));
  EXPECT_EQ(band.width, 25);
  EXPECT_EQ(band.height, 31);
  EXPECT_EQ(band.bytes, plane.bytes);
  EXPECT_GT(*std::max_element(band.bytes.begin(), band.bytes.end()), 0);
  const auto smear = exchange::read_png(path("smear.png"));
  EXPECT_EQ(smear.bytes, std::vector<std::uint8_t>(25 * 31, 0));
  const Json json = read("band.json");
  EXPECT_EQ(json["rows"], 31);
  EXPECT_EQ(json["columns"], 25);
  EXPECT_EQ(json["smeared_rows"], 0);
  EXPECT_EQ(json["flow"], "exact");
  EXPECT_NEAR(json["curve"]["length_mm"].get<double>(), 15, 1e-9);
}

TEST_F(CurveVerbs, SmearPictureMarksTheShockOfACorner) {
  write_recording();
  for (const char* method : {"exact", "route-map"}) {
    ASSERT_EQ(run_tool(manifold({"--curve", "5,4 15,4 15,14", "--smooth-px", "0", "--reach-mm", "4",
                                 "--thickness-mm", "4", "--flow", method, "--smear", path("smear.png")}))
                  .exit_code,
              0);
    const auto smear = exchange::read_png(path("smear.png"));
    ASSERT_EQ(smear.height, 41);
    int rows = 0;
    for (int y = 0; y < 41; ++y) {
      rows += smear.bytes[static_cast<std::size_t>(y) * static_cast<std::size_t>(smear.width)] == 255;
      // Four layers on the inside, 2 k cot 45 degrees = 8 rows about the corner in row 20.
      EXPECT_EQ(smear.bytes[static_cast<std::size_t>(y * smear.width)], std::abs(y - 20) <= 4 ? 255 : 0) << y;
    }
    EXPECT_NEAR(rows, 8, 1);
  }
}

// Grey that stands still would be the scanner's drawing; columns 20 to 29 flow.
TEST_F(CurveVerbs, ManifoldOfADopplerRecordingIsInColour) {
  exchange::TrackedSequence s;
  s.width = 60;
  s.height = 40;
  s.components = 3;
  s.frames.resize(30);
  s.pixels = exchange::PixelBuffer(3 * 60 * 40 * 30);
  for (int i = 0; i < 30; ++i) {
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose(0, 0) = pose(1, 1) = pose(2, 2) = 0.5;
    pose(2, 3) = 0.5 * i;
    exchange::set_transform(s.frames[static_cast<std::size_t>(i)], {"Image", "Reference"}, pose);
    for (int k = 0; k < 60 * 40; ++k) {
      const bool flows = k % 60 >= 20 && k % 60 < 30;
      std::uint8_t* c = s.pixels.bytes().data() + 3 * (static_cast<std::size_t>(i) * 2400 + k);
      c[0] = static_cast<std::uint8_t>(flows ? (i % 2 == 0 ? 250 : 200) : 40 + 3 * i);
      c[1] = c[2] = static_cast<std::uint8_t>(flows ? 4 : c[0]);
    }
  }
  exchange::write_sequence(s, path("sweep.mha"));
  ASSERT_EQ(
      run_tool(manifold({"--curve", "5,4 20,4 24,10", "--reach-mm", "5", "--thickness-mm", "2"})).exit_code,
      0);
  const auto band = exchange::read_png(path("band.png"));
  ASSERT_EQ(band.channels, 3);
  // One row is one ruling, 0.5 mm on from x = 5 mm: row 14 is column 24, row 2 column 12.
  const auto at = [&](int row) { return &band.bytes[3 * static_cast<std::size_t>(row * band.width + 10)]; };
  EXPECT_GT(at(14)[0], 190);
  EXPECT_LT(at(14)[2], 40);
  EXPECT_EQ(at(2)[0], at(2)[2]);
}

TEST_F(CurveVerbs, ManifoldSaysWhatIsWrongWithACurve) {
  write_recording();
  const auto refused = [&](const std::string& curve, const std::string& reach) {
    std::filesystem::remove(path("band.png"));
    const ToolRun run = run_tool(manifold({"--curve", curve, "--reach-mm", reach}));
    EXPECT_EQ(run.exit_code, 2) << curve;
    EXPECT_FALSE(std::filesystem::exists(path("band.png"))) << curve;
    return run.err;
  };
  EXPECT_THAT(refused("5,4", "6"),
              HasSubstr("--curve: the curve has all its points in one place; draw at least two"));
  EXPECT_THAT(refused("5,4 5,4", "6"),
              HasSubstr("--curve: the curve has all its points in one place; draw at least two"));
  EXPECT_THAT(refused("5,4 5;9", "6"), HasSubstr("--curve: '5;9' is not 2 numbers with commas between"));
  EXPECT_THAT(refused("5,4 nan,9", "6"), HasSubstr("--curve: 'nan,9' is not 2 numbers with commas between"));
  EXPECT_THAT(refused("5,4 15,4", "-1"), HasSubstr("--reach-mm: '-1' is not a number from 0 to 10000"));
  EXPECT_THAT(refused("0,0 1e7,0", "6"),
              HasSubstr("--curve: the curve is longer than 65536 pixels or points; draw a shorter one"));
  EXPECT_EQ(run_tool(manifold({"--curve", "5,4 15,4", "--reach-mm", "9000"})).exit_code, 0);
}

TEST_F(CurveVerbs, SayHowTheyAreUsed) {
  EXPECT_EQ(run_tool({"manifold", "--help"}).exit_code, 0);
  EXPECT_EQ(run_tool({"flow", "--help"}).exit_code, 0);
}

}  // namespace
}  // namespace sonoband::test
