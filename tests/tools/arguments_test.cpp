// Arguments that make no sense: one sentence that names the place and the cure, and nothing written.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "app/exchange/sequence_file.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Arguments : public ToolTest {
 protected:
  Arguments() {
    exchange::TrackedSequence s;
    s.width = 30;
    s.height = 20;
    s.frames.resize(10);
    s.pixels = exchange::PixelBuffer(30 * 20 * 10);
    for (int i = 0; i < 10; ++i) {
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose(2, 3) = i;
      exchange::set_transform(s.frames[static_cast<std::size_t>(i)], {"Image", "Reference"}, pose);
    }
    exchange::write_sequence(s, sweep);
    std::ofstream(curve) << "0,0\n9,0\n9,9\n";
  }

  ToolRun run(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return run_tool(words);
  }
  std::vector<std::string> render() { return {"render", sweep, "--out", path("out.png")}; }
  std::vector<std::string> manifold() {
    return {"manifold", sweep, "--curve", "2,2 12,2 12,9", "--reach-mm", "4", "--out", path("out.png")};
  }
  std::vector<std::string> flow() {
    return {"flow", "--curve", curve, "--step-mm", "1", "--layers", "2", "--out", path("out.json")};
  }
  void refused(const std::vector<std::string>& verb, const std::vector<std::string>& more,
               const std::string& sentence) {
    const ToolRun result = run(verb, more);
    EXPECT_EQ(result.exit_code, 2) << sentence;
    EXPECT_THAT(result.err, HasSubstr(sentence));
    EXPECT_TRUE(
        std::all_of(result.err.begin(), result.err.end(), [](char c) { return c == '\n' || c >= ' '; }))
        << "control characters: " << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("out.png")) || std::filesystem::exists(path("out.json")));
  }

  const std::string sweep = path("sweep.mha"), curve = path("curve.csv");
};

// CLI11's ranges let it pass: it compares false with both ends.
TEST_F(Arguments, NotANumberIsNoLength) {
  for (const char* nan : {"nan", "inf", "1e999", "2mm"}) {
    const std::string quoted = std::string("'") + nan + "' is not a number from ";
    refused(manifold(), {"--reach-mm", nan}, "--reach-mm: " + quoted + "0 to 10000");
    refused(manifold(), {"--smooth-px", nan}, "--smooth-px: " + quoted + "0 to 1000");
    refused(manifold(), {"--pixel-mm", nan}, "--pixel-mm: " + quoted + "0.0001 to 1000");
    refused(render(), {"--thickness-mm", nan}, "--thickness-mm: " + quoted + "0 to 1000");
    refused(flow(), {"--step-mm", nan}, "--step-mm: " + quoted + "0.0001 to 1000");
    refused({"voxels", sweep, "--out", path("out.mha")}, {"--spacing-mm", nan},
            "--spacing-mm: " + quoted + "0.001 to 1000");
    EXPECT_FALSE(std::filesystem::exists(path("out.mha")));
  }
}

TEST_F(Arguments, AWordThatIsNoneOfThoseAskedForIsAnsweredWithThem) {
  refused(manifold(), {"--flow", "route_map"}, "--flow: 'route_map' is none of exact, naive, route-map");
  refused(flow(), {"--method", "fast"}, "--method: 'fast' is none of exact, naive, route-map");
  refused(flow(), {"--method", "0"}, "--method: '0' is none of exact, naive, route-map");
  refused(render(), {"--compounding", "avg"}, "--compounding: 'avg' is none of max, mean, min");
  refused(render(), {"--interpolation", "cubic"}, "--interpolation: 'cubic' is none of linear, nearest");
  refused(render(), {"--colour", "Dopler"}, "--colour: 'Dopler' is none of auto, doppler, grey");
  EXPECT_EQ(run(flow(), {"--method", "Naive"}).exit_code, 0);
  EXPECT_THAT(run_tool({"manifold", "--help"}).out, HasSubstr("exact|naive|route-map"));
}

TEST_F(Arguments, WhatIsReadIsNotWrittenOver) {
  const std::string before = bytes_of(sweep), points = bytes_of(curve);
  std::filesystem::create_hard_link(sweep, path("link.mha"));
  const std::string lost = " is SEQ, which is read and would be lost; name another file";
  for (const std::string& out : {sweep, (folder / "." / "sweep.mha").string(), path("link.mha")}) {
    refused({"render", sweep}, {"--out", out}, "--out: " + out + lost);
    refused(render(), {"--coverage", out}, "--coverage: " + out + lost);
    refused(manifold(), {"--json", out}, "--json: " + out + lost);
    refused(manifold(), {"--smear", out}, "--smear: " + out + lost);
    refused({"voxels", sweep, "--spacing-mm", "1"}, {"--out", out}, "--out: " + out + lost);
  }
  refused({"flow", "--curve", curve, "--step-mm", "1", "--layers", "2"}, {"--out", curve},
          "--out: " + curve + " is --curve, which is read and would be lost; name another file");
  EXPECT_TRUE(bytes_of(sweep) == before);
  EXPECT_TRUE(bytes_of(curve) == points);
}

TEST_F(Arguments, TwoOutputsAreTwoFiles) {
  refused(manifold(), {"--json", path("out.png")},
          "--json: " + path("out.png") + " is also what --out writes; name another file");
  refused(manifold(), {"--coverage", path("c.png"), "--smear", path("c.png")},
          "--smear: " + path("c.png") + " is also what --coverage writes; name another file");
}

// A script's variable that is not set must not render every frame, or nowhere.
TEST_F(Arguments, AnEmptyValueIsNotTheDefault) {
  for (const char* option : {"--frames", "--world", "--clip", "--origin", "--calibration", "--json"})
    refused(render(), {option, ""}, std::string(option) + ": is empty; give a value, or leave it out");
  refused(manifold(), {"--smear", ""}, "--smear: is empty");
  refused({"render", "", "--out", path("out.png")}, {}, "SEQ: is empty");
  refused({"flow", "--curve", "", "--step-mm", "1", "--layers", "2", "--out", path("out.json")}, {},
          "--curve: is empty");
}

TEST_F(Arguments, AFolderIsNoFile) {
  const auto says = [&](const ToolRun& result, const std::string& sentence) {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("sonoband-tool: " + sentence));
  };
  const std::string here = folder.string();
  says(run_tool({"flow", "--curve", here, "--step-mm", "1", "--layers", "2", "--out", path("o.json")}),
       here + ": this is a folder; give a file of lines x,y in mm");
  says(run_tool({"render", sweep, "--out", here}),
       here + ": cannot be written: this is a folder; name a file in it");
}

TEST_F(Arguments, CurvesOfSpreadsheetsAreRead) {
  ASSERT_EQ(run_tool(flow()).exit_code, 0);
  const std::string plain = bytes_of(path("out.json"));
  for (const char* text : {"\xEF\xBB\xBFx,y\r\n0,0\r\n9,0\r\n9,9\r\n",
                           "\xEF\xBB\xBF"
                           "0,0\n9,0\n9,9\n",
                           "# drawn by hand\nX,Y\n0,0\n9,0\n9,9"}) {
    std::ofstream(curve) << text;
    const ToolRun result = run_tool(flow());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(bytes_of(path("out.json")), plain);
  }
}

TEST_F(Arguments, BytesOfAFileDoNotReachTheTerminal) {
  std::ofstream(curve) << "0,0\n\x1b[2J\x07,1\n";
  const ToolRun result = run_tool(flow());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("curve.csv:2: '?[2J?,1' is not x,y"));
}

TEST_F(Arguments, APictureBesideTheRecordingIsWarnedAbout) {
  const std::vector<std::string> far{"--origin", "500,0,0", "--right", "1,0,0",
                                     "--down",   "0,1,0",   "--size",  "9x9"};
  for (const auto& verb : {render(), manifold()}) {
    EXPECT_THAT(run(verb, far).err, HasSubstr("warning: no pixel has data: all of the picture lies beside"));
    EXPECT_THAT(run(verb, {}).err, Not(HasSubstr("no pixel has data")));
  }
}

}  // namespace
}  // namespace sonoband::test
