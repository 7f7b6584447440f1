// Movies as another program sees them: ffprobe tells times and texts, ffmpeg decodes the pictures.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "app/bad_input.h"
#include "app/exam/exam_writer.h"
#include "app/exam/sweep_loader.h"
#include "app/exchange/exam_export.h"
#include "app/exchange/exam_movie.h"
#include "app/exchange/movie.h"
#include "tests/tools/processes.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

Bytes decoded(const fs::path& movie, const std::string& format) {
  const std::string raw = movie.string() + ".raw";
  const Output run = shell("ffmpeg -v error -y -i " + movie.string() +
                           " -vsync passthrough -f rawvideo -pix_fmt " + format + " " + raw);
  EXPECT_EQ(run.exit_code, 0) << run.text;
  std::ifstream in(raw, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

nlohmann::json probed(const fs::path& movie) {
  const Output run =
      shell("ffprobe -v error -show_format -show_streams -show_frames -of json " + movie.string());
  EXPECT_EQ(run.exit_code, 0) << run.text;
  return nlohmann::json::parse(run.text, nullptr, false);
}

// Peak signal to noise, dB, of bytes.
double psnr(const std::uint8_t* a, const std::uint8_t* b, std::size_t size) {
  double sum = 0;
  for (std::size_t i = 0; i < size; ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(size) / std::max(sum, 1e-9));
}

class Movie : public ToolTest {
 protected:
  static constexpr int width = 96;
  static constexpr int height = 71;
  static constexpr int count = 20;
  static constexpr std::size_t size = std::size_t{width} * height;

  // Speckle four pixels wide in pictures that step along their normal; crooked times; rectangular pixels.
  Movie() {
    std::mt19937_64 random(21);
    exam::SweepSetup setup;
    setup.width = width;
    setup.height = height;
    setup.probe_from_image.emplace();
    setup.probe_from_image->linear << 0.2, 0, 0, 0, 0.1, 0, 0, 0, 0.2;
    exam::ExamWriter writer = exam::ExamWriter::create(file, "20260102-030405-f117");
    writer.set_label("Somebody");
    writer.begin_sweep(1, setup);
    std::vector<exam::FrameRecord> frames;
    for (int i = 0; i < count; ++i) {
      std::vector<double> cells(30 * 25);
      for (double& c : cells) c = static_cast<double>(random() % 256);
      pictures.emplace_back(width, height);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const int at = y / 4 * 30 + x / 4;
          const double u = x % 4 / 4.0;
          const double v = y % 4 / 4.0;
          pictures.back().view()(x, y) =
              static_cast<std::uint8_t>((1 - v) * ((1 - u) * cells[at] + u * cells[at + 1]) +
                                        v * ((1 - u) * cells[at + 30] + u * cells[at + 31]));
        }
    }
    for (int i = 0; i < count; ++i) {
      exam::FrameRecord f;
      f.pixels = pictures[static_cast<std::size_t>(i)].view();
      f.number = i;
      f.pre_roll = i < 2;
      // 33 ms each, but for a pause of 400 ms.
      f.captured = Stamp(std::chrono::milliseconds(5000 + 33 * i + (i > 11 ? 400 : 0)));
      f.pose_status = PoseStatus::ok;
      Rigid<frame::World, frame::Probe> pose;
      pose.translation = {0, 0, 0.4 * i};
      f.world_from_image = pose.affine() * *setup.probe_from_image;
      frames.push_back(f);
    }
    writer.append(1, frames, {});
    writer.end_sweep(1, count, {});
    writer.close();
  }

  std::string file = path("20260102-030405-f117.exam");
  std::vector<Pixels> pictures;
};

TEST_F(Movie, ACineShowsEachFrameAtItsTime) {
  const ToolRun run = run_tool({"export", file, "--to", path("out"), "--format", "webm"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path movie = path("out/20260102-030405-f117-sweep1.webm");
  const nlohmann::json said = probed(movie);
  ASSERT_EQ(said["frames"].size(), std::size_t{count});
  for (int i = 0; i < count; ++i)
    EXPECT_NEAR(std::stod(said["frames"][i]["pts_time"].get<std::string>()), 0.033 * i + (i > 11 ? 0.4 : 0),
                5e-4);
  // The last one stays as long as the others did on average.
  EXPECT_NEAR(std::stod(said["format"]["duration"].get<std::string>()), 1.027 * 20 / 19, 2e-3);
  const nlohmann::json& stream = said["streams"][0];
  EXPECT_EQ(stream["codec_name"], "vp9");
  EXPECT_EQ(stream["width"], width);
  EXPECT_EQ(stream["height"], height);
  // Pixels twice as wide as high.
  EXPECT_EQ(stream["sample_aspect_ratio"], "2:1");
  const nlohmann::json& tags = said["format"]["tags"];
  EXPECT_EQ(tags["DISCLAIMER"], "Research use only.");
  EXPECT_EQ(tags["PIXEL_SIZE_MM"], "0.2 x 0.1");
  EXPECT_EQ(tags["TITLE"], "20260102-030405-f117-sweep1");
  EXPECT_EQ(said.dump().find("Somebody"), std::string::npos);

  const Bytes bytes = decoded(movie, "gray");
  ASSERT_EQ(bytes.size(), size * count);
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* shown = bytes.data() + size * static_cast<std::size_t>(i);
    EXPECT_GT(psnr(shown, pictures[static_cast<std::size_t>(i)].view().data, size), 38) << "frame " << i;
    EXPECT_LT(psnr(shown, pictures[static_cast<std::size_t>((i + 1) % count)].view().data, size), 20);
  }
  for (const auto& e : fs::directory_iterator(path("out")))
    EXPECT_NE(e.path().extension(), ".unfinished") << e.path();
}

// The tool's own choices are the screen's; and it says how far it is, and leaves nothing when stopped.
TEST_F(Movie, AWholeTurnIsTheSameFromTheScreen) {
  exchange::ExamExport what;
  what.format = exchange::ExportFormat::turn;
  what.to = path("screen");
  what.band.band.thickness_mm = 1;
  std::vector<int> told;
  const exchange::ExportedExam made = exchange::export_exam(file, what, [&](int permille) {
    told.push_back(permille);
    return true;
  });
  ASSERT_EQ(made.files.size(), 1U);
  EXPECT_EQ(made.files[0], path("screen/20260102-030405-f117-sweep1-turn.webm"));
  EXPECT_TRUE(made.damage.empty());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1000);
  const ToolRun run = run_tool({"export", file, "--to", path("out"), "--format", "webm", "--turn-table",
                                "--thickness-mm", "1", "--threads", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Bytes screen = decoded(made.files[0], "gray");
  EXPECT_FALSE(screen.empty());
  EXPECT_EQ(screen, decoded(path("out/20260102-030405-f117-sweep1-turn.webm"), "gray"));

  what.to = path("stopped");
  EXPECT_THROW(exchange::export_exam(file, what, [](int permille) { return permille < 300; }), BadInput);
  EXPECT_TRUE(fs::is_empty(path("stopped")));
}

TEST_F(Movie, ATurnTableShowsTheBandOfEachAngle) {
  const ToolRun run =
      run_tool({"export",       file,         "--to",  path("out"),      "--format", "webm",
                "--turn-table", "--pictures", "12",    "--per-second",   "10",       "--origin",
                "-2,0,4",       "--right",    "1,0,0", "--down",         "0,1,0",    "--size",
                "120x60",       "--pixel-mm", "0.2",   "--thickness-mm", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path movie = path("out/20260102-030405-f117-sweep1-turn.webm");
  const nlohmann::json said = probed(movie);
  ASSERT_EQ(said["frames"].size(), 12u);
  EXPECT_NEAR(std::stod(said["frames"][7]["pts_time"].get<std::string>()), 0.7, 5e-4);
  EXPECT_NEAR(std::stod(said["format"]["duration"].get<std::string>()), 1.2, 2e-3);
  const Bytes bytes = decoded(movie, "gray");
  const std::size_t shown = 120 * 60;
  ASSERT_EQ(bytes.size(), 12 * shown);

  exam::SweepLoader sweep(file, 1);
  sweep.wait();
  std::vector<const TrackedFrame*> swept;  // without what came before the press
  for (int i = 2; i < count; ++i) swept.push_back(&sweep.frame(i));
  Serial serial;
  RenderSettings settings;
  settings.band = {1, 0.2};
  for (int i = 0; i < 12; ++i) {
    // Turned about the line through the picture's middle, along `down`.
    const double a = 2 * std::numbers::pi * i / 12;
    const Eigen::Vector3d right(std::cos(a), 0, -std::sin(a));
    const Eigen::Vector3d middle(-2 + 0.2 * 59.5, 0.2 * 29.5, 4);
    const auto plane = make_plane(middle - 0.2 * 59.5 * right - Eigen::Vector3d(0, 0.2 * 29.5, 0), right,
                                  Eigen::Vector3d::UnitY(), 120, 60, 0.2);
    const BandImage band = render_planar({swept, sweep.mask()}, *plane, settings, serial);
    const auto* coverage = band.coverage.view().data;
    EXPECT_GT(std::count_if(coverage, coverage + shown, [](auto c) { return c > 0; }), 500);
    EXPECT_GT(psnr(bytes.data() + shown * static_cast<std::size_t>(i), band.pixels.view().data, shown), 35)
        << "picture " << i;
  }
}

TEST_F(Movie, ATurnTablesOwnPlaneKeepsTheWholeSweepInThePicture) {
  exam::SweepLoader sweep(file, 1);
  sweep.wait();
  const std::vector<const TrackedFrame*> frames = sweep.renderable();
  for (const auto axis : {exchange::TurnAxis::down, exchange::TurnAxis::right}) {
    const auto plane = exchange::turn_table_plane({frames, {}}, axis, 64);
    ASSERT_TRUE(plane);
    EXPECT_LE(std::max(plane->width, plane->height), 64);
    for (int i = 0; i < 8; ++i) {
      const auto turned = exchange::turned_about(*plane, axis, 0.25 * std::numbers::pi * i);
      const auto plane_from_world = turned.world_from_plane().inverse();
      for (const TrackedFrame* f : frames)
        for (const double x : {0.0, width - 1.0})
          for (const double y : {0.0, height - 1.0}) {
            const Eigen::Vector3d p =
                (plane_from_world * (f->world_from_image * Point<frame::Image>{{x, y, 0}})).v /
                turned.pixel_mm;
            EXPECT_GT(p.x(), -1);
            EXPECT_LT(p.x(), turned.width);
            EXPECT_GT(p.y(), -1);
            EXPECT_LT(p.y(), turned.height);
          }
    }
  }
}

TEST_F(Movie, ColoursAreThoseOfThePicture) {
  exchange::PngPicture flat{.width = 33, .height = 17, .channels = 3, .bytes = {}, .texts = {}};
  exchange::MovieSettings settings;
  settings.width = 33;
  settings.height = 17;
  settings.duration_s = 0.3;
  const std::uint8_t colours[3][3] = {{200, 30, 40}, {20, 60, 220}, {128, 128, 128}};
  exchange::MovieWriter movie(path("c.webm"), settings);
  for (int i = 0; i < 3; ++i) {
    flat.bytes.clear();
    for (int k = 0; k < 33 * 17; ++k) flat.bytes.insert(flat.bytes.end(), colours[i], colours[i] + 3);
    movie.add(flat, 0.1 * i);
  }
  movie.finish();
  const Bytes bytes = decoded(path("c.webm"), "rgb24");
  ASSERT_EQ(bytes.size(), 3u * 33 * 17 * 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (const std::size_t pixel : {std::size_t{0}, std::size_t{33 * 8 + 16}, std::size_t{33 * 17 - 1}})
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(bytes[(i * 33 * 17 + pixel) * 3 + c], colours[i][c], 5) << i << " " << pixel << " " << c;
}

TEST_F(Movie, AStopLeavesNoFile) {
  const exam::ExamReader exam(file);
  const exchange::ExportedSweep sweep = exchange::sequence_from_exam(exam, 1);
  int asked = 0;
  EXPECT_THROW(exchange::write_cine(sweep, "s", path("stopped.webm"), 1, [&](int) { return ++asked < 4; }),
               BadInput);
  EXPECT_EQ(asked, 4);
  for (const auto& e : fs::directory_iterator(folder))
    EXPECT_EQ(e.path().string().find("stopped"), std::string::npos) << e.path();
  exchange::MovieSettings none;
  EXPECT_THROW(exchange::MovieWriter(path("none.webm"), none), BadInput);
  EXPECT_THROW(exchange::write_cine(sweep, "s", path("nowhere/a.webm"), 1), BadInput);
  EXPECT_EQ(run_tool({"export", file, "--to", path("out"), "--turn-table"}).exit_code, 2);
}

}  // namespace
}  // namespace sonoband::test
