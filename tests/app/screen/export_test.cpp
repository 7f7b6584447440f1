// Export from the screen: to a folder and to a stick, what it says while it runs and when it cannot, and
// taking the stick away safely.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <fstream>

#include "app/exam/exam_reader.h"
#include "app/exchange/sequence_file.h"
#include "tests/app/screen/golden.h"
#include "tests/app/screen/screen_support.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;
using ui::ExportPhase;

ScreenCartSettings exporting(const fs::path& folder) {
  ScreenCartSettings settings;
  settings.exams = folder / "exams";
  settings.screen.shots = folder / "shots";
  settings.screen.exports.folder = folder / "out";
  // No stick of the machine that runs the test.
  settings.screen.exports.media = {folder / "mountinfo", folder / "sys", folder / "labels"};
  return settings;
}

ui::ExportView transfer(const ScreenCart& cart) {
  return cart.loop().view().exams.transfer;
}
bool reached(ScreenCart& cart, ExportPhase phase) {
  return until(cart, [&] { return transfer(cart).phase == phase; });
}

void record(ScreenCart& cart) {
  cart.play("await live 5\nwait 1.5\npress\nwait 1\nrelease\nawait review 5\nwait 0.3\n");
  ASSERT_TRUE(until(cart, [&] {
    const exam::RecorderStatus s = cart.cart().exams()->status();
    return s.state == exam::RecorderStatus::State::saved && s.stored == s.published;
  }));
}

void open_sheet(ScreenCart& cart) {
  cart.play("tap rail/exams\n");
  ASSERT_TRUE(until(cart, [&] { return cart.has("exams/0"); }));
  cart.play("tap exams/0\ntap exams/export\n");
  ASSERT_TRUE(until(cart, [&] { return cart.has("export/place-0"); }));
}

// In two frames; a script's taps take half a second.
void tap_quickly(ScreenCart& cart, const char* name) {
  const auto widget = cart.loop().screen().widgets().find(name);
  ASSERT_TRUE(widget && widget->enabled) << name;
  for (const auto kind : {ui::Contact::Kind::down, ui::Contact::Kind::up}) {
    cart.player().input().contacts.push_back({cart.clock().now(), kind, 0, widget->rect.centre(), 0});
    cart.player().frame();
  }
  cart.loop().draw({}, cart.clock().now());  // what it changed, at the same moment
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& e : fs::recursive_directory_iterator(folder, none))
    if (e.is_regular_file()) files.push_back(e.path());
  return files;
}

TEST(ExportOnTheScreen, AnExamGoesToTheFolderAndReadsBack) {
  const fs::path folder = scratch_folder();
  ScreenCartSettings settings = exporting(folder);
  settings.pixels = true;
  ScreenCart cart(settings);
  record(cart);
  open_sheet(cart);
  EXPECT_EQ(transfer(cart).phase, ExportPhase::idle);
  EXPECT_FALSE(cart.has("export/remove")) << "a folder cannot be pulled";
  cart.play("tap export/dicom\ntap export/label\n");
  EXPECT_TRUE(transfer(cart).choice.with_label);
  expect_golden(cart, "export",
                {"exams/0", "export/place-0", "status/scanner", "status/tracker", "status/ring"});
  cart.play("tap export/mha\n");
  cart.play("tap export/start\n");
  ASSERT_TRUE(reached(cart, ExportPhase::done)) << transfer(cart).sentence;
  EXPECT_EQ(transfer(cart).sentence, "");
  const auto files = files_below(folder / "out");
  EXPECT_EQ(transfer(cart).files, static_cast<int>(files.size()));
  int sequences = 0;
  for (const fs::path& f : files) {
    if (f.extension() != ".mha") continue;
    ++sequences;
    EXPECT_EQ(exchange::read_sequence(f).sequence.frame_count(), cart.cart().exams()->status().stored);
  }
  EXPECT_EQ(sequences, 1);
  // The sheet says the choice again once something else is chosen.
  cart.play("tap export/nrrd\n");
  EXPECT_EQ(transfer(cart).phase, ExportPhase::idle);
}

TEST(ExportOnTheScreen, TheSweepUnderReviewGoesWithWhatWasJustDrawn) {
  const fs::path folder = scratch_folder();
  ScreenCart cart(exporting(folder));
  record(cart);
  cart.play("tap rail/live\nwait 0.5\n");
  record(cart);
  // The list follows the disk by a moment.
  ASSERT_TRUE(until(cart, [&] {
    cart.play("tap tools/export\n");
    return cart.has("export/start");
  }));
  ASSERT_TRUE(until(cart, [&] { return cart.has("export/place-0"); }));
  EXPECT_TRUE(transfer(cart).choice.one_sweep);
  cart.play("tap export/png\ntap export/start\n");
  ASSERT_TRUE(reached(cart, ExportPhase::done)) << transfer(cart).sentence;
  EXPECT_FALSE(files_below(folder / "out").empty());
  for (const fs::path& f : files_below(folder / "out"))
    EXPECT_NE(f.filename().string().find("-sweep2-"), std::string::npos) << f;
  // Drawn, and exported before it can have come to rest: 0.2 s are twelve frames.
  cart.play("tap sheet/close\ntap tools/mark\n");
  for (const char* widget : {"reslice/picture", "tools/move", "tools/export", "export/marks", "export/start"})
    tap_quickly(cart, widget);
  ASSERT_TRUE(reached(cart, ExportPhase::done)) << transfer(cart).sentence;
  bool marked = false;
  for (const fs::path& f : files_below(folder / "out")) marked = marked || f.string().ends_with(".mrk.json");
  EXPECT_TRUE(marked);
}

TEST(ExportOnTheScreen, CancelledItLeavesNoHalfFileAndTheCartRecordsOn) {
  const fs::path folder = scratch_folder();
  ScreenCart cart(exporting(folder));
  record(cart);
  open_sheet(cart);
  cart.play("tap export/webm\ntap export/start\ntap export/cancel\n");
  ASSERT_TRUE(until(cart, [&] { return !transfer(cart).running(); }));
  if (transfer(cart).phase == ExportPhase::cancelled) {
    EXPECT_TRUE(files_below(folder / "out").empty());
  }
  // The sheet may be closed and a sweep recorded while it runs; what came of it is said.
  cart.play("tap export/png\n");
  tap_quickly(cart, "export/start");
  cart.player().frame();
  ASSERT_TRUE(transfer(cart).running());
  cart.play("tap sheet/close\ntap rail/live\npress\nwait 1\nrelease\nawait review 5\n");
  ASSERT_TRUE(until(cart, [&] { return cart.loop().view().notice.starts_with("Exported to "); }));
  EXPECT_GT(files_below(folder / "out").size(), 20u);
}

// What is in it: Movie.AWholeTurnIsTheSameFromTheScreen.
TEST(ExportOnTheScreen, ATurnTableSaysHowFarItIsAndCanBeStopped) {
  const fs::path folder = scratch_folder();
  ScreenCart cart(exporting(folder));
  record(cart);
  open_sheet(cart);
  cart.play("tap export/turn\n");
  tap_quickly(cart, "export/start");
  // Beyond the reading, a tenth, and a whole turn is far off.
  const auto turning = [&] {
    const ui::ExportView e = transfer(cart);
    return e.phase == ExportPhase::failed || (e.phase == ExportPhase::exporting && e.done > 0.105);
  };
  ASSERT_TRUE(until(cart, turning, std::chrono::seconds(60)));
  ASSERT_EQ(transfer(cart).phase, ExportPhase::exporting) << transfer(cart).sentence;
  tap_quickly(cart, "export/cancel");
  ASSERT_TRUE(until(cart, [&] { return !transfer(cart).running(); }));
  EXPECT_EQ(transfer(cart).phase, ExportPhase::cancelled);
  EXPECT_TRUE(files_below(folder / "out").empty());
}

TEST(ExportOnTheScreen, WhyItFailsIsSaid) {
  const fs::path folder = scratch_folder();
  ScreenCart cart(exporting(folder));
  record(cart);
  std::ofstream(folder / "out") << "a file where a folder should be";
  open_sheet(cart);
  cart.play("tap export/start\n");
  ASSERT_TRUE(reached(cart, ExportPhase::failed));
  EXPECT_NE(transfer(cart).sentence.find("the folder is not there"), std::string_view::npos)
      << transfer(cart).sentence;
  // And again, when that is cured.
  fs::remove(folder / "out");
  cart.play("tap export/start\n");
  EXPECT_TRUE(reached(cart, ExportPhase::done)) << transfer(cart).sentence;
}

TEST(ExportOnTheScreen, WithoutAnyPlaceItAsksForAStick) {
  const fs::path folder = scratch_folder();
  ScreenCartSettings settings = exporting(folder);
  settings.screen.exports.folder.clear();
  ScreenCart cart(settings);
  record(cart);
  cart.play("tap rail/exams\n");
  ASSERT_TRUE(until(cart, [&] { return cart.has("exams/0"); }));
  cart.play("tap exams/0\ntap exams/export\nwait 0.3\n");
  EXPECT_FALSE(cart.has("export/place-0"));
  EXPECT_FALSE(cart.loop().screen().widgets().find("export/start")->enabled);
}

// 40 MB, without a process of its own: the screen's rasteriser does not survive a fork.
struct SmallStick {
  explicit SmallStick(fs::path place) : path(std::move(place)) {
    fs::create_directories(path);
    mounted = ::mount("none", path.c_str(), "tmpfs", 0, "size=40m,mode=700") == 0;
  }
  ~SmallStick() {
    if (mounted) ::umount2(path.c_str(), MNT_DETACH);
  }
  SmallStick(const SmallStick&) = delete;
  SmallStick& operator=(const SmallStick&) = delete;
  fs::path path;
  bool mounted = false;
};

// A disk of its own that the kernel's tree calls a stick.
TEST(ExportOnTheScreen, AStickComesFirstIsFilledAndTakenAwaySafely) {
  const fs::path folder = scratch_folder();
  const SmallStick disk_of_its_own(folder / "stick");
  if (!disk_of_its_own.mounted)
    GTEST_SKIP() << "mounting a file system takes root and a machine that lets it";
  const fs::path stick = folder / "stick";
  struct stat s {};
  ASSERT_EQ(::stat(stick.c_str(), &s), 0);
  const fs::path disk = folder / "sys/devices/usb1/1-1/block/sdb";
  fs::create_directories(disk);
  fs::create_directories(folder / "sys/dev/block");
  std::ofstream(disk / "removable") << "1\n";
  fs::create_symlink(disk, folder / "sys/dev/block" /
                               (std::to_string(major(s.st_dev)) + ":" + std::to_string(minor(s.st_dev))));
  ScreenCartSettings settings = exporting(folder);
  settings.screen.exports.media.mounts = "/proc/self/mountinfo";
  ScreenCart cart(settings);
  record(cart);
  open_sheet(cart);
  ASSERT_TRUE(until(cart, [&] { return transfer(cart).places.size() == 2; }));
  EXPECT_TRUE(transfer(cart).places[0].removable);
  EXPECT_EQ(transfer(cart).choice.place, 0);
  cart.play("tap export/start\n");
  ASSERT_TRUE(reached(cart, ExportPhase::done)) << transfer(cart).sentence;
  EXPECT_FALSE(files_below(stick).empty());
  EXPECT_TRUE(files_below(folder / "out").empty());
  // As pictures it does not fit twice over: what is there stays.
  const auto there = files_below(stick).size();
  std::ofstream filler(stick / "filler");
  for (int i = 0; i < 40 && filler; ++i) filler << std::string(1 << 20, 'x') << std::flush;
  filler.close();
  cart.play("tap export/nrrd\ntap export/start\n");
  ASSERT_TRUE(reached(cart, ExportPhase::failed));
  EXPECT_NE(transfer(cart).sentence.find("free some space"), std::string_view::npos)
      << transfer(cart).sentence;
  EXPECT_LE(files_below(stick).size(), there + 3) << "small files beside it may have fitted";
  cart.play("tap export/remove\n");
  ASSERT_TRUE(reached(cart, ExportPhase::removed)) << transfer(cart).sentence;
  EXPECT_TRUE(files_below(stick).empty()) << "it is unmounted";
  ASSERT_TRUE(until(cart, [&] { return transfer(cart).places.size() == 1; }));
  EXPECT_FALSE(cart.has("export/remove"));
}

}  // namespace
}  // namespace sonoband::test
