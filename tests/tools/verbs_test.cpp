// The verbs on a synthetic recording whose every voxel is known.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/exchange/png.h"
#include "app/exchange/sequence_file.h"
#include "tests/support/support.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

// 20 frames of 40 x 30 pixels of 0.5 mm, 1 mm apart along z: frame i is i+1 everywhere, but frame 10 has a
// bright pixel at (12, 8), which is (6, 4, 10) mm in Reference.
class Verbs : public ToolTest {
 protected:
  Verbs() {
    exchange::TrackedSequence s;
    s.width = 40;
    s.height = 30;
    s.frames.resize(20);
    s.pixels = exchange::PixelBuffer(40 * 30 * 20);
    for (int i = 0; i < 20; ++i) {
      std::fill_n(s.pixels.bytes().begin() + i * 1200, 1200, static_cast<std::uint8_t>(i + 1));
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose(2, 3) = i;
      auto& frame = s.frames[static_cast<std::size_t>(i)];
      exchange::set_transform(frame, {"Probe", "Reference"}, pose);
      exchange::set_field(frame.fields, "Timestamp", std::to_string(5 + 0.04 * i));
    }
    s.pixels.bytes()[10 * 1200 + 8 * 40 + 12] = 250;
    exchange::write_sequence(s, sequence);
    std::ofstream(calibration) << "<PlusConfiguration><CoordinateDefinitions><Transform From='Image' "
                                  "To='Probe' Matrix='0.5 0 0 0 0 0.5 0 0 "
                                  "0 0 0.5 0 0 0 0 1'/><Transform From='Reference' To='World' Matrix='1 0 0 "
                                  "100 0 1 0 0 0 0 1 0 0 0 0 1'/>"
                                  "</CoordinateDefinitions><VolumeReconstruction ClipRectangleOrigin='0 0' "
                                  "ClipRectangleSize='40 20'/>"
                                  "</PlusConfiguration>";
  }

  ToolRun render(std::vector<std::string> more) {
    std::vector<std::string> words{"render",    sequence, "--calibration",
                                   calibration, "--out",  path("out.png")};
    words.insert(words.end(), more.begin(), more.end());
    return run_tool(words);
  }
  std::uint8_t pixel(int x, int y, const std::string& file = "out.png") {
    const auto picture = exchange::read_png(path(file));
    return picture.bytes[static_cast<std::size_t>(y) * picture.width + x];
  }

  std::string sequence = path("sweep.igs.mha");
  std::string calibration = path("plus.xml");
  // Pixel (x, y) at (x / 2, 4, y / 2) mm.
  std::vector<std::string> across{"--origin", "0,4,0",  "--right", "2,0,0",      "--down",
                                  "0.1,0,1",  "--size", "40x39",   "--pixel-mm", "0.5"};

  // Greys that change from frame to frame, and flow that pulsates between two colours at (12..15, 8).
  void write_flow(const doppler::Rgb& even, const doppler::Rgb& odd) const {
    exchange::TrackedSequence s;
    s.width = 40;
    s.height = 30;
    s.components = 3;
    s.frames.resize(20);
    s.pixels = exchange::PixelBuffer(3 * 40 * 30 * 20);
    for (int i = 0; i < 20; ++i) {
      std::uint8_t* frame = s.pixels.bytes().data() + static_cast<std::size_t>(i) * 3600;
      std::fill_n(frame, 3600, static_cast<std::uint8_t>(40 + 3 * i));
      const doppler::Rgb& colour = i % 2 == 0 ? even : odd;
      for (std::size_t x = 12; x < 16; ++x) {
        std::uint8_t* c = frame + (8 * 40 + x) * 3;
        c[0] = colour.r;
        c[1] = colour.g;
        c[2] = colour.b;
      }
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose(2, 3) = i;
      exchange::set_transform(s.frames[static_cast<std::size_t>(i)], {"Probe", "Reference"}, pose);
    }
    exchange::write_sequence(s, sequence);
  }

  std::vector<std::string> across_and(std::vector<std::string> more) const {
    std::vector<std::string> words = across;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Verbs, ADopplerRecordingGivesAPictureInColour) {
  write_flow({250, 4, 4}, {200, 4, 4});
  ASSERT_EQ(render(across_and({"--thickness-mm", "2", "--json", path("s.json")})).exit_code, 0);
  const auto picture = exchange::read_png(path("out.png"));
  ASSERT_EQ(picture.channels, 3);
  const auto at = [&](int x, int y) { return &picture.bytes[3 * static_cast<std::size_t>(y * 40 + x)]; };
  EXPECT_GT(at(13, 20)[0], 190);
  EXPECT_LT(at(13, 20)[2], 40);
  EXPECT_EQ(at(30, 20)[0], at(30, 20)[1]);
  EXPECT_EQ(Json::parse(std::ifstream(path("s.json")))["pixels"], "doppler");
  ASSERT_EQ(render(across_and({"--colour", "grey"})).exit_code, 0);
  EXPECT_EQ(exchange::read_png(path("out.png")).channels, 1);
  EXPECT_EQ(render(across_and({"--colour", "green"})).exit_code, 2);
}

// Green towards the probe: on the usual bar it is no flow, and what is no flow is masked.
TEST_F(Verbs, FlowIsReadAndShownByTheScannersOwnBar) {
  write_flow({8, 240, 8}, {8, 200, 8});
  const auto colour = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"--thickness-mm", "2", "--colour", "doppler"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(render(across_and(words)).exit_code, 0);
    const auto picture = exchange::read_png(path("out.png"));
    const std::uint8_t* c = &picture.bytes[3 * static_cast<std::size_t>(20 * 40 + 13)];
    return doppler::Rgb{c[0], c[1], c[2]};
  };
  const doppler::Rgb green = colour({"--towards", "0,64,0 0,255,0"});
  // The brighter pulse, within the classifier's steps of 8 greys.
  EXPECT_NEAR(green.g, 240, 12);
  EXPECT_EQ(green.r, 0);
  EXPECT_EQ(green.b, 0);
  const doppler::Rgb usual = colour({});
  EXPECT_EQ(usual.r, usual.g);
  EXPECT_EQ(usual.g, usual.b);

  const auto refused = [&](const std::string& bar) {
    const ToolRun run = render(across_and({"--away", bar}));
    EXPECT_EQ(run.exit_code, 2) << bar;
    return run.err;
  };
  EXPECT_THAT(refused("0,0,255"), HasSubstr("--away: one colour is no bar; give at least two"));
  EXPECT_THAT(refused("0,0,255 0,0,256"), HasSubstr("--away: '0,0,256' is no colour; give R,G,B"));
  EXPECT_THAT(refused("0,0 0,0,25"), HasSubstr("--away: '0,0' is not 3 numbers"));
}

TEST_F(Verbs, HelpIsSuccessAndWrongUsageIsTwo) {
  EXPECT_EQ(run_tool({"--help"}).exit_code, 0);
  for (const char* verb : {"info", "render", "voxels", "convert"})
    EXPECT_EQ(run_tool({verb, "--help"}).exit_code, 0) << verb;
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{},
                                             {"dance"},
                                             {"info"},
                                             {"info", "--banana", "x"},
                                             {"convert", "one"},
                                             {"render", sequence},
                                             {"voxels", sequence, "--out", "v.mha"}})
    EXPECT_EQ(run_tool(words).exit_code, 2);
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--origin", "1,2,3"},
           {"--origin", "1,2", "--right", "1,0,0", "--down", "0,1,0", "--size", "4x4"},
           {"--origin", "1,2,3", "--right", "1,0,0", "--down", "2,0,0", "--size", "4x4"},
           {"--origin", "1,2,3", "--right", "1,0,0", "--down", "0,1,0", "--size", "4"},
           {"--origin", "1,2,3", "--right", "1,0,0", "--down", "0,1,0", "--size", "4x0"},
           {"--origin", "nan,2,3", "--right", "1,0,0", "--down", "0,1,0", "--size", "4x4"},
           {"--frames", "7-3"},
           {"--frames", "x"},
           {"--clip", "1,2,3"},
           {"--clip", "1,2,3,0"},
           {"--mask", "some"},
           {"--gap-mm", "-1"},
           {"--gap-mm", "wide"},
           {"--thickness-mm", "-2"},
           {"--pixel-mm", "0"},
           {"--compounding", "median"},
           {"--interpolation", "cubic"}}) {
    const ToolRun run = render(more);
    EXPECT_EQ(run.exit_code, 2) << more[0] << ' ' << more[1] << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("out.png")));
  }
}

TEST_F(Verbs, BadInputIsOneSentenceAndOne) {
  const ToolRun gone = run_tool({"info", path("gone.mha")});
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_SAYS(gone.err, "gone.mha: cannot be opened");
  EXPECT_EQ(std::count(gone.err.begin(), gone.err.end(), '\n'), 1);
  EXPECT_EQ(render({"--world", "Moon"}).exit_code, 1);
  EXPECT_EQ(render({"--frames", "3-99"}).exit_code, 1);
  EXPECT_EQ(render({"--clip", "500,0,3,3"}).exit_code, 1);
  EXPECT_EQ(run_tool({"convert", sequence, path("x.avi")}).exit_code, 1);
}

TEST_F(Verbs, RenderPutsTheBrightPixelWhereItIs) {
  // 12 x 0.5 mm = 6 mm; z = 10 mm at row 20.
  EXPECT_EQ(render(across).exit_code, 0);
  EXPECT_EQ(pixel(12, 20), 250);
  EXPECT_EQ(pixel(13, 20), 11);
  EXPECT_EQ(pixel(12, 22), 12);
  EXPECT_EQ(pixel(0, 0), 1);
}

TEST_F(Verbs, RenderMakesDownOrthogonalAndWorldsMove) {
  EXPECT_EQ(render({"--world", "World", "--origin", "100,4,0", "--right", "2,0,0", "--down", "0.3,0,1",
                    "--size", "40x39", "--pixel-mm", "0.5"})
                .exit_code,
            0);
  EXPECT_EQ(pixel(12, 20), 250);
}

TEST_F(Verbs, NegativeNumbersAreValuesNotOptions) {
  EXPECT_EQ(render({"--origin", "-.5,-1,-2", "--right", "-1,0,0", "--down", "0,-1,0", "--size", "4x4",
                    "--pixel-mm", "0.5", "--clip", "-3,-3,20,20"})
                .exit_code,
            0);
}

TEST_F(Verbs, ThicknessReachesWhatAThinSliceMisses) {
  // A plane at y = 8 mm misses the bright pixel at 4 mm by exactly 8 steps of 0.5 mm.
  const std::vector<std::string> off{"--origin", "0,8,0",  "--right", "1,0,0",      "--down",
                                     "0,0,1",    "--size", "40x39",   "--pixel-mm", "0.5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), off.begin(), off.end());
    EXPECT_EQ(render(more).exit_code, 0);
    return pixel(12, 20);
  };
  EXPECT_EQ(with({}), 11);
  EXPECT_EQ(with({"--thickness-mm", "7"}), 11);
  EXPECT_EQ(with({"--thickness-mm", "8"}), 250);
  EXPECT_EQ(with({"--thickness-mm", "8", "--compounding", "min"}), 11);
  // 16 of 17 layers are in the clip rectangle (y up to 19 px = 9.5 mm leaves 4.0 to 9.5): 12 layers.
  EXPECT_EQ(with({"--thickness-mm", "8", "--compounding", "mean"}), (250 + 11 * 11 + 6) / 12);
}

TEST_F(Verbs, RenderWritesCoverageAndStatistics) {
  EXPECT_EQ(render(across_and({"--frames", "5-14", "--gap-mm", "0.5", "--thickness-mm", "2", "--coverage",
                               path("cov.png"), "--json", path("stats.json")}))
                .exit_code,
            0);
  EXPECT_EQ(pixel(3, 8, "cov.png"), 0);     // z = 4 mm, before frame 5
  EXPECT_EQ(pixel(3, 9, "cov.png"), 255);   // half a mm before it
  EXPECT_EQ(pixel(3, 29, "cov.png"), 255);  // half a mm after frame 14
  EXPECT_EQ(pixel(3, 30, "cov.png"), 0);
  const Json json = Json::parse(std::ifstream(path("stats.json")));
  EXPECT_EQ(json["plane"]["size"], Json({40, 39}));
  EXPECT_EQ(json["plane"]["world"], "Reference");
  EXPECT_EQ(json["plane"]["right"], Json({1.0, 0.0, 0.0}));
  EXPECT_EQ(json["plane"]["down"], Json({0.0, 0.0, 1.0}));
  EXPECT_EQ(json["band"]["layers"], 5);
  EXPECT_EQ(json["band"]["step_mm"], 0.5);
  EXPECT_EQ(json["compounding"], "max");
  EXPECT_EQ(json["interpolation"], "nearest");
  EXPECT_EQ(json["gap_mm"], 0.5);
  EXPECT_EQ(json["frames"]["used"], 10);
  EXPECT_DOUBLE_EQ(json["coverage"], 21.0 / 39.0);
  EXPECT_TRUE(json.contains("milliseconds"));
}

TEST_F(Verbs, TheMaskHidesAndNoneShows) {
  // Rows of the B-scans from 20 on are clipped away: y = 12 mm is row 24.
  const std::vector<std::string> low{"--origin",   "0,12,0", "--right",    "1,0,0",
                                     "--down",     "0,0,1",  "--size",     "40x39",
                                     "--pixel-mm", "0.5",    "--coverage", path("cov.png")};
  EXPECT_EQ(render(low).exit_code, 0);
  EXPECT_EQ(pixel(5, 5, "cov.png"), 0);
  auto all = low;
  all.insert(all.end(), {"--mask", "none"});
  EXPECT_EQ(render(all).exit_code, 0);
  EXPECT_EQ(pixel(5, 5, "cov.png"), 255);
}

TEST_F(Verbs, WithoutAPlaneOneIsTakenAndPrinted) {
  const ToolRun run = render({"--interpolation", "linear"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_SAYS(run.out, "plane: --origin ");
  // What is printed gives the same picture again.
  const auto first = exchange::read_png(path("out.png"));
  std::vector<std::string> words{"--interpolation", "linear"};
  std::istringstream printed(run.out.substr(7, run.out.find('\n') - 7));
  for (std::string word; printed >> word;) words.push_back(word);
  EXPECT_EQ(render(words).exit_code, 0);
  EXPECT_EQ(exchange::read_png(path("out.png")).bytes, first.bytes);
}

TEST_F(Verbs, ThreadsDoNotChangeThePicture) {
  EXPECT_EQ(render({"--threads", "1", "--thickness-mm", "3"}).exit_code, 0);
  const auto one = exchange::read_png(path("out.png")).bytes;
  EXPECT_EQ(render({"--threads", "3", "--thickness-mm", "3"}).exit_code, 0);
  EXPECT_EQ(exchange::read_png(path("out.png")).bytes, one);
}

TEST_F(Verbs, VoxelsLieWhereTheHeaderSays) {
  EXPECT_EQ(run_tool({"voxels", sequence, "--calibration", calibration, "--spacing-mm", "1", "--origin",
                      "-1,0,0", "--dims", "10,6,25", "--gap-mm", "0.4", "--out", path("v.mha")})
                .exit_code,
            0);
  const auto volume = exchange::read_sequence(path("v.mha"));
  const auto& s = volume.sequence;
  EXPECT_TRUE(volume.warnings.empty());
  EXPECT_EQ(s.slices, 25);
  EXPECT_EQ(s.geometry.origin_mm, (std::vector<double>{-1, 0, 0}));
  EXPECT_EQ(s.geometry.spacing_mm, (std::vector<double>{1, 1, 1}));
  const auto voxel = [&](int i, int j, int k) {
    return s.pixels.bytes()[static_cast<std::size_t>(k) * 60 + static_cast<std::size_t>(j) * 10 +
                            static_cast<std::size_t>(i)];
  };
  EXPECT_EQ(voxel(7, 4, 10), 250);
  EXPECT_EQ(voxel(6, 4, 10), 11);
  EXPECT_EQ(voxel(0, 0, 0), 0);  // x = -1 mm is outside every picture
  EXPECT_EQ(voxel(1, 0, 0), 1);
  EXPECT_EQ(voxel(1, 0, 19), 20);
  EXPECT_EQ(voxel(1, 0, 20), 0);  // past the last frame
}

TEST_F(Verbs, VoxelsWithoutALatticeSurroundTheMaskedSweep) {
  EXPECT_EQ(run_tool({"voxels", sequence, "--calibration", calibration, "--spacing-mm", "0.5", "--clip",
                      "4,2,100,8", "--out", path("v.mha")})
                .exit_code,
            0);
  const auto s = exchange::read_sequence(path("v.mha")).sequence;
  EXPECT_EQ(s.geometry.origin_mm, (std::vector<double>{2, 1, 0}));
  EXPECT_EQ(s.width, 36);
  EXPECT_EQ(s.height, 8);
  EXPECT_EQ(s.slices, 39);
  EXPECT_EQ(run_tool({"voxels", sequence, "--calibration", calibration, "--spacing-mm", "0.5", "--origin",
                      "0,0,0", "--out", path("v.mha")})
                .exit_code,
            2);
}

TEST_F(Verbs, ConvertKeepsEverything) {
  for (const char* name : {"a.nrrd", "b.mhd", "c.igs.mha"}) {
    EXPECT_EQ(run_tool({"convert", sequence, path(name), "--compress"}).exit_code, 0);
    const auto a = exchange::read_sequence(sequence).sequence;
    const auto b = exchange::read_sequence(path(name)).sequence;
    EXPECT_TRUE(b.compressed);
    ASSERT_EQ(a.frame_count(), b.frame_count());
    for (std::size_t i = 0; i < a.frames.size(); ++i) EXPECT_EQ(a.frames[i].fields, b.frames[i].fields);
    const auto pa = a.pixels.bytes();
    const auto pb = b.pixels.bytes();
    EXPECT_TRUE(std::equal(pa.begin(), pa.end(), pb.begin(), pb.end()));
  }
}

TEST_F(Verbs, InfoCountsAndMeasures) {
  const ToolRun run = run_tool({"info", sequence, "--calibration", calibration, "--json"});
  EXPECT_EQ(run.exit_code, 0);
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["frames"], 20);
  EXPECT_EQ(json["width"], 40);
  EXPECT_NEAR(json["time"]["rate_hz"], 25, 1e-6);
  EXPECT_NEAR(json["time"]["duration_s"], 0.76, 1e-9);
  EXPECT_EQ(json["transforms"][0]["name"], "ProbeToReference");
  EXPECT_EQ(json["transforms"][0]["status"]["OK"], 20);
  EXPECT_EQ(json["motion"]["of"], "Image");
  EXPECT_NEAR(json["motion"]["path_mm"], 19, 1e-9);
  EXPECT_NEAR(json["motion"]["speed_mm_s"]["median"], 25, 1e-6);
  EXPECT_NEAR(json["motion"]["axes_deg"], 90, 1e-9);
  const ToolRun text = run_tool({"info", sequence});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_SAYS(text.out, "20 frames of 40 x 30");
}

TEST_F(Verbs, InfoFindsGapsJumpsAndLostPoses) {
  auto s = exchange::read_sequence(sequence).sequence;
  for (std::size_t i = 8; i < 20; ++i)
    exchange::set_field(s.frames[i].fields, "Timestamp", std::to_string(5.5 + 0.04 * static_cast<double>(i)));
  Eigen::Matrix4d far = Eigen::Matrix4d::Identity();
  far(0, 3) = 50;
  exchange::set_transform(s.frames[19], {"Probe", "Reference"}, far);
  exchange::set_transform(s.frames[3], {"Probe", "Reference"}, far, "OUT_OF_VIEW");
  exchange::set_transform(s.frames[4], {"Probe", "Reference"}, 2 * far);  // no pose
  exchange::write_sequence(s, path("bad.mha"));
  const ToolRun run = run_tool({"info", path("bad.mha"), "--json"});
  EXPECT_EQ(run.exit_code, 0);
  const Json json = Json::parse(run.out);
  ASSERT_EQ(json["time"]["gaps"].size(), 1u);
  EXPECT_EQ(json["time"]["gaps"][0]["after_frame"], 7);
  ASSERT_EQ(json["motion"]["jumps"].size(), 1u);
  EXPECT_EQ(json["motion"]["jumps"][0]["after_frame"], 18);
  EXPECT_EQ(json["motion"]["without_pose"], Json({{3, 4}}));
  EXPECT_EQ(json["transforms"][0]["status"]["OUT_OF_VIEW"], 1);
  EXPECT_EQ(json["transforms"][0]["not_a_pose"], 1);
  EXPECT_EQ(json["warnings"].size(), 1u);
}

}  // namespace
}  // namespace sonoband::test
