// exams, export, import and verify on an exam whose every pixel is known.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "app/cart_on_board.h"
#include "app/exam/exam_writer.h"
#include "app/exam/sweep_loader.h"
#include "core/reslice/band.h"
#include "core/reslice/default_plane.h"
#include "hal/sim/virtual_clock.h"
#include "tests/support/support.h"
#include "tests/tools/processes.h"
#include "tests/tools/tool_runner.h"

namespace sonoband::test {
namespace {

class ExamVerbs : public ToolTest {
 protected:
  // 24 frames of 40 x 30 noisy pixels along a path with crooked numbers, a sheared calibration, a mask; each
  // sixth frame has no pose.
  ExamVerbs() {
    std::mt19937_64 random(11);
    exam::SweepSetup setup;
    setup.width = 40;
    setup.height = 30;
    setup.probe_from_image.emplace();
    setup.probe_from_image->linear << 0.1, 0.007, 0, 0.003, 0.09, 0, 0.01, 0, 0.1;
    setup.mask = Pixels(40, 30);
    for (int i = 0; i < 1200; ++i) setup.mask.view().data[i] = i % 40 > 4;
    exam::ExamWriter writer = exam::ExamWriter::create(file, "20260102-030405-beef");
    writer.set_label("Somebody");
    writer.begin_sweep(1, setup);
    std::vector<Pixels> pictures;
    std::vector<exam::FrameRecord> frames;
    for (int i = 0; i < 24; ++i) {
      pictures.emplace_back(40, 30);
      for (int k = 0; k < 1200; ++k) pictures.back().view().data[k] = static_cast<std::uint8_t>(random());
    }
    for (int i = 0; i < 24; ++i) {
      exam::FrameRecord f;
      f.pixels = pictures[static_cast<std::size_t>(i)].view();
      f.number = i;
      f.pre_roll = i < 2;
      f.captured = Stamp(Duration(123'456'789'012'345 + 16'666'667 * i));
      f.stamped = f.captured + Duration(64'800'001);
      f.arrived = f.stamped + Duration(77);
      f.device_ns = 5 + i;
      f.device_count = 100 + static_cast<std::uint64_t>(i);
      f.pose_status = i % 6 == 5 ? PoseStatus::gap : PoseStatus::ok;
      Rigid<frame::World, frame::Probe> pose;
      pose.rotation = Eigen::AngleAxisd(0.013 * i, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
      pose.translation = {0.1 * i, 1.0 / 3, 0.37 * i};
      TrackedFrame placed;
      set_pose(placed, pose.affine() * *setup.probe_from_image);
      if (i % 6 != 5) f.world_from_image = placed.world_from_image;
      frames.push_back(f);
    }
    writer.append(1, frames, {});
    writer.end_sweep(1, 24, {{"received", 24}});
    writer.close();
  }

  std::string file = path("20260102-030405-beef.exam");
};

BandImage render(const exam::SweepLoader& sweep) {
  Serial serial;
  const std::vector<const TrackedFrame*> frames = sweep.renderable();
  const auto plane = make_plane({0, 1, -1}, {1, 0, 0}, {0, 0, 1}, 60, 120, 0.08);
  RenderSettings settings;
  settings.band = {2, 0.1};
  return render_planar({frames, sweep.mask()}, *plane, settings, serial);
}

TEST_F(ExamVerbs, ExportedAndImportedItRendersTheSameBits) {
  for (const std::string format : {"mha", "nrrd", "mhd"}) {
    const std::string to = path("out-" + format);
    const ToolRun exported = run_tool({"export", file, "--to", to, "--format", format});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    const std::string written = exported.out.substr(0, exported.out.find('\n'));
    ASSERT_TRUE(std::filesystem::exists(written));
    // The label stays where it is.
    for (const auto& entry : std::filesystem::directory_iterator(to)) {
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      EXPECT_EQ(text.find("Somebody"), std::string::npos) << entry.path();
    }
    const ToolRun imported = run_tool({"import", written, "--into", path("again-" + format)});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    exam::SweepLoader a(file, 1);
    exam::SweepLoader b(imported.out.substr(0, imported.out.find('\n')), 1);
    a.wait();
    b.wait();
    ASSERT_EQ(a.total(), b.total());
    for (std::int64_t i = 0; i < a.total(); ++i) {
      const exam::FrameRecord& ra = a.stored(i).record;
      const exam::FrameRecord& rb = b.stored(i).record;
      EXPECT_EQ(ra.pose_status, rb.pose_status);
      EXPECT_EQ(ra.pre_roll, rb.pre_roll);
      EXPECT_EQ(ra.captured, rb.captured);
      EXPECT_EQ(ra.stamped, rb.stamped);
      EXPECT_EQ(ra.arrived, rb.arrived);
      EXPECT_EQ(ra.device_ns, rb.device_ns);
      EXPECT_EQ(ra.device_count, rb.device_count);
      if (ra.pose_status != PoseStatus::ok) continue;
      EXPECT_EQ(a.frame(i).image_from_world.linear, b.frame(i).image_from_world.linear);
      EXPECT_EQ(a.frame(i).image_from_world.translation, b.frame(i).image_from_world.translation);
    }
    const BandImage first = render(a);
    const BandImage second = render(b);
    const std::size_t size = static_cast<std::size_t>(first.pixels.width()) * first.pixels.height();
    const auto* coverage = first.coverage.view().data;
    ASSERT_GT(std::count_if(coverage, coverage + size, [](auto c) { return c > 0; }), 100);
    EXPECT_TRUE(
        std::equal(first.pixels.view().data, first.pixels.view().data + size, second.pixels.view().data));
    EXPECT_TRUE(std::equal(coverage, coverage + size, second.coverage.view().data));
    const exam::SweepSetup& setup = b.setup();
    EXPECT_EQ(setup.probe_from_image->linear, a.setup().probe_from_image->linear);
    // Not a hidden exam, not half a one.
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(name.find("importing"), std::string::npos);
      EXPECT_EQ(name.find("unfinished"), std::string::npos);
    }
  }
}

// From the pedal of the simulated cart to a file of another program's format and back.
TEST_F(ExamVerbs, ASweepOfTheCartComesBackFromMetaImageAndRendersTheSameBits) {
  const auto clock = std::make_shared<sim::VirtualClock>();
  Profile profile;
  profile.ring.frames = 100;
  profile.capture.crop_px = {220, 80, 200, 200};
  BoardDevices board = make_sim_board(profile, *clock);
  const auto cart = make_appliance(board, profile, clock, path("cart"));
  const ClockMember member(*clock);
  const auto wait = [&](double s) { clock->sleep_until(clock->now() + from_seconds(s)); };
  cart->start();
  wait(1.5);
  board.foot(true);
  wait(0.8);
  board.foot(false);
  wait(0.7);
  cart->stop();
  const Sweep sweep = cart->take_sweep().value();
  ASSERT_GT(sweep.view().frames.size(), 20u);
  const std::string id = cart->exams()->exam_id();

  const ToolRun exported = run_tool({"export", id, "--exams", path("cart"), "--to", path("mha")});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const ToolRun imported =
      run_tool({"import", exported.out.substr(0, exported.out.find('\n')), "--into", path("back")});
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  exam::SweepLoader loader(imported.out.substr(0, imported.out.find('\n')), 1);
  loader.wait();
  // The swept frames, as the cart renders them.
  std::vector<const TrackedFrame*> swept;
  for (std::int64_t i = 0; i < loader.total(); ++i)
    if (!loader.stored(i).record.pre_roll && loader.frame(i).pose_status == PoseStatus::ok)
      swept.push_back(&loader.frame(i));
  ASSERT_EQ(swept.size(), sweep.view().frames.size());

  Serial serial;
  for (const PlaneView view : {PlaneView::level, PlaneView::upright}) {
    for (const double thickness_mm : {0.0, 8.0}) {
      RenderSettings settings;
      settings.band = {thickness_mm, 0.2};
      const ReslicePlane plane = *default_plane(sweep.view(), view, 0.5);
      const BandImage on_cart = render_planar(sweep.view(), plane, settings, serial);
      const BandImage back = render_planar({swept, loader.mask()}, plane, settings, serial);
      const std::size_t size = static_cast<std::size_t>(on_cart.pixels.width()) * on_cart.pixels.height();
      const auto* coverage = on_cart.coverage.view().data;
      ASSERT_GT(std::count_if(coverage, coverage + size, [](auto c) { return c > 0; }), 1000);
      EXPECT_TRUE(
          std::equal(on_cart.pixels.view().data, on_cart.pixels.view().data + size, back.pixels.view().data));
      EXPECT_TRUE(std::equal(coverage, coverage + size, back.coverage.view().data));
    }
  }
}

TEST_F(ExamVerbs, ListsExams) {
  const ToolRun run = run_tool({"exams", folder.string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto exams = nlohmann::json::parse(run.out).at("exams");
  ASSERT_EQ(exams.size(), 1u);
  EXPECT_EQ(exams[0].at("id"), "20260102-030405-beef");
  EXPECT_EQ(exams[0].at("path"), file);
  EXPECT_EQ(exams[0].at("frames"), 24);
  EXPECT_EQ(run.out.find("Somebody"), std::string::npos);
  EXPECT_EQ(run_tool({"exams", path("none")}).exit_code, 1);
}

TEST_F(ExamVerbs, VerifyNamesThePlaceOfDamage) {
  const ToolRun whole = run_tool({"verify", "20260102", "--exams", folder.string()});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(whole.out.find("24 frames"), std::string::npos) << whole.out;
  // The pictures are noise: each lies in the file as it is.
  exam::SweepLoader sweep(file, 1, 7);
  const ConstPixels picture = sweep.frame(7).bscan.pixels;
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(picture.data) + 500, 40));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  const std::string damaged = path("20270101-000000-0000.exam");
  std::ofstream(damaged, std::ios::binary) << bytes;
  const ToolRun run = run_tool({"verify", damaged});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("sweep 1, frame 7: the picture is damaged"), std::string::npos) << run.err;
  // What is left can be had, and what is not is said.
  const ToolRun rest = run_tool({"export", damaged, "--to", path("rest")});
  EXPECT_EQ(rest.exit_code, 1);
  EXPECT_NE(rest.err.find("frame 7"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(path("rest/20270101-000000-0000-sweep1.igs.mha")));
}

// What is wrong is said of it once by its name.
TEST_F(ExamVerbs, VerifySaysTheNameOfAFileThatIsNoExamOnce) {
  const std::string other = path("20280101-000000-0000.exam");
  ASSERT_EQ(std::system(("cp " + file + " " + other).c_str()), 0);
  std::string bytes;
  {
    std::ifstream in(other, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::vector<std::string> wrong = {"no exam at all", bytes, bytes, bytes.substr(0, 4096)};
  wrong[1][68] = 'x';                                                        // SQLite's application id
  std::fill(wrong[2].begin() + 4096, wrong[2].end(), static_cast<char>(7));  // every page but the first
  for (const std::string& contents : wrong) {
    std::ofstream(other, std::ios::binary) << contents;
    const ToolRun run = run_tool({"verify", other});
    EXPECT_EQ(run.exit_code, 1);
    const std::string name = "20280101-000000-0000.exam";
    const std::size_t first = run.err.find(name);
    ASSERT_NE(first, std::string::npos) << run.err;
    EXPECT_EQ(run.err.find(name, first + 1), std::string::npos) << run.err;
  }
}

TEST_F(ExamVerbs, WritesWhatReviewMade) {
  {
    exam::ExamWriter writer = exam::ExamWriter::open(file);
    writer.add_review({.object = "l1",
                       .kind = exam::ReviewKind::landmark,
                       .json = R"({"label":"apex","position_mm":[1,2,3]})",
                       .png = {}});
    writer.close();
  }
  const ToolRun run = run_tool({"export", file, "--to", path("review"), "--format", "review"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::ifstream ours(path("review/20260102-030405-beef-review.json"));
  EXPECT_EQ(nlohmann::json::parse(ours)["review"][0]["holds"]["label"], "apex");
  std::ifstream slicer(path("review/20260102-030405-beef.mrk.json"));
  EXPECT_EQ(nlohmann::json::parse(slicer)["markups"][0]["controlPoints"][0]["label"], "apex");
}

TEST_F(ExamVerbs, WritesPictures) {
  const ToolRun run = run_tool({"export", file, "--to", path("png"), "--format", "png", "--sweep", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("png/20260102-030405-beef-sweep1-00023.png")));
  EXPECT_NE(run.out.find("24 pictures"), std::string::npos) << run.out;
  // On the machine's own disk there is nothing to pull.
  const ToolRun eject = run_tool({"export", file, "--to", path("png"), "--format", "review", "--eject"});
  EXPECT_EQ(eject.exit_code, 1);
  EXPECT_NE(eject.err.find("no disk that can be pulled"), std::string::npos) << eject.err;
  EXPECT_EQ(run_tool({"places", "--json"}).exit_code, 0);
  EXPECT_EQ(run_tool({"export", file, "--to", path("png"), "--sweep", "9"}).exit_code, 1);
}

TEST_F(ExamVerbs, ServesASweepOverOpenIGTLink) {
  const std::uint16_t port = free_port();
  ToolRun served;
  std::thread server([&] {
    served = run_tool({"serve", file, "--igtl", std::to_string(port), "--for", "0.6"});
  });
  std::string got;
  for (int i = 0; i < 100 && got.find("IMAGE") == std::string::npos; ++i) {
    if (const int s = connected(port); s >= 0) {
      char bytes[4096];
      for (ssize_t n; got.size() < 20000 && (n = ::recv(s, bytes, sizeof bytes, 0)) > 0;)
        got.append(bytes, static_cast<std::size_t>(n));
      ::close(s);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  server.join();
  EXPECT_EQ(served.exit_code, 0) << served.err;
  EXPECT_NE(got.find("STATUS"), std::string::npos);
  EXPECT_NE(got.find("ImageToTracker"), std::string::npos);
  EXPECT_NE(got.find("IMAGE"), std::string::npos);
}

TEST_F(ExamVerbs, TheSpineRecordingGoesInAndOut) {
  SONOBAND_DATA_OR_SKIP(data);
  const ToolRun in = run_tool(
      {"import", (data / "dev/SpinePhantomFreehand.igs.mha").string(), "--into", path("e"), "--calibration",
       (data / "config/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml").string()});
  ASSERT_EQ(in.exit_code, 0) << in.err;
  const std::string exam = in.out.substr(0, in.out.find('\n'));
  EXPECT_EQ(run_tool({"verify", exam}).exit_code, 0);
  exam::SweepLoader sweep(exam, 1);
  sweep.wait();
  EXPECT_EQ(sweep.total(), 21);
  EXPECT_EQ(sweep.setup().width, 820);
}

}  // namespace
}  // namespace sonoband::test
