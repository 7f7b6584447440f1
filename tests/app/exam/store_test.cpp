// What goes into an exam comes out of it, and nothing else does.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <fstream>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/exam_writer.h"
#include "app/exam/schema.h"
#include "app/exam/setup_json.h"
#include "app/exam/sweep_loader.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exam {
namespace {

using test::differences;
using test::MadeSweep;
using test::TemporaryFolder;

// An exam of one sweep of `frames` frames, written in batches of seven.
std::filesystem::path recorded(const TemporaryFolder& folder, std::int64_t frames, std::uint64_t seed = 1,
                               int width = 40, int height = 24) {
  std::filesystem::path file = folder.path() / "20260102-030405-aaaa.exam";
  ExamWriter writer = ExamWriter::create(file, "20260102-030405-aaaa");
  MadeSweep sweep(width, height, frames, seed);
  sweep.publish(frames);
  writer.begin_sweep(1, test::small_setup(width, height));
  for (std::int64_t at = 0; at < frames; at += 7) {
    std::vector<FrameRecord> batch;
    for (std::int64_t i = at; i < std::min(frames, at + 7); ++i) batch.push_back(sweep.frame(i));
    std::vector<PoseSample> poses(4 * batch.size());
    sweep.take_poses(poses);
    writer.append(1, batch, poses);
  }
  writer.end_sweep(1, frames, sweep.ledger());
  writer.close();
  return file;
}

void execute(const std::filesystem::path& file, const std::string& sql, std::string* error = nullptr) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  const int code = sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
  if (error != nullptr) {
    *error = code == SQLITE_OK ? "" : sqlite3_errmsg(db);
  } else {
    EXPECT_EQ(code, SQLITE_OK) << sqlite3_errmsg(db);
  }
  sqlite3_close(db);
}

TEST(Exam, GivesBackEveryPixelAndNumber) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 25);
  EXPECT_FALSE(std::filesystem::exists(file.string() + "-wal"));  // closed: one file
  EXPECT_EQ(differences(file, 1, 1, 25), std::vector<std::string>{});
  const ExamReader reader(file);
  const std::vector<SweepSummary> sweeps = reader.sweeps();
  ASSERT_EQ(sweeps.size(), 1u);
  EXPECT_EQ(sweeps[0].frames, 25);
  EXPECT_TRUE(sweeps[0].ended);
  EXPECT_FALSE(sweeps[0].interrupted);
  ASSERT_EQ(sweeps[0].ledger.size(), 3u);
  EXPECT_EQ(sweeps[0].ledger[2], (Counter{"lost_duplicate", 2}));
  EXPECT_TRUE(reader.summary().closed);
}

TEST(Exam, FramesBehindTheEndAreNotSeen) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "e.exam";
  MadeSweep sweep(16, 16, 9, 4);
  ExamWriter writer = ExamWriter::create(file, "e");
  writer.begin_sweep(1, test::small_setup(16, 16));
  std::vector<FrameRecord> batch;
  for (std::int64_t i = 0; i < 9; ++i) batch.push_back(sweep.frame(i));
  writer.append(1, batch, {});
  writer.end_sweep(1, 7, {});
  const ExamReader reader(file);
  const StoredFrames stored = reader.frames(1);
  EXPECT_EQ(stored.frames.size(), 7u);
  EXPECT_EQ(stored.damage, std::vector<std::string>{});
  EXPECT_EQ(reader.summary().frames, 7);
}

TEST(Exam, KeepsTheSetupBitForBit) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 1);
  const SweepSetup a = test::small_setup(40, 24);
  const SweepSetup b = ExamReader(file).setup(1);
  EXPECT_EQ(b.probe_from_image->linear, a.probe_from_image->linear);
  EXPECT_EQ(b.probe_from_image->translation, a.probe_from_image->translation);
  EXPECT_EQ(b.crop, a.crop);
  EXPECT_EQ(b.latency_offset, a.latency_offset);
  EXPECT_EQ(b.versions, a.versions);
  EXPECT_EQ(b.pressed, a.pressed);
  EXPECT_EQ(b.pressed_utc_ns, a.pressed_utc_ns);
  EXPECT_EQ(b.world, a.world);
  EXPECT_EQ(b.calibration_name, a.calibration_name);
  EXPECT_EQ(b.calibration_error_mm, a.calibration_error_mm);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) ASSERT_EQ(b.mask.view()(x, y), a.mask.view()(x, y));
}

TEST(Exam, StridesAreNotStored) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "e.exam";
  Pixels wide(50, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 50; ++x) wide.view()(x, y) = static_cast<std::uint8_t>(x < 40 ? x ^ y : 255);
  FrameRecord f = test::record(0, 1, {wide.view().data, 40, 24, 50});
  {
    ExamWriter writer = ExamWriter::create(file, "e");
    writer.begin_sweep(1, test::small_setup(40, 24));
    writer.append(1, {&f, 1}, {});
  }
  const ExamReader reader(file);
  const StoredFrames stored = reader.frames(1);
  ASSERT_EQ(stored.frames.size(), 1u);
  Pixels out(40, 24);
  ASSERT_EQ(reader.pixels(1, stored.frames[0], out.view()), "");
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) ASSERT_EQ(out.view()(x, y), x ^ y);
}

TEST(Exam, OnlyThisUserCanReadIt) {
  const TemporaryFolder folder;
  const ::mode_t before = ::umask(0);
  const std::filesystem::path place = folder.path() / "deep" / "exams";
  {
    const ExamFolder exams(place, ExamFolder::Use::cart);
    const ExamFolder::NewExam made = exams.new_exam();
    ExamWriter writer = ExamWriter::create(made.file, made.id);
    writer.begin_sweep(1, test::small_setup(8, 8));
    EXPECT_EQ(exams.list().size(), 1u);
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(place)) {
      ++files;
      EXPECT_EQ(entry.status().permissions(),
                std::filesystem::perms::owner_read | std::filesystem::perms::owner_write)
          << entry.path();
    }
    EXPECT_GE(files, 4);  // the exam, its journal and that one's index, the folder's index, the lock
  }
  EXPECT_EQ(std::filesystem::status(place).permissions(), std::filesystem::perms::owner_all);
  ::umask(before);
}

TEST(Exam, RefusesToRewriteItself) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 3);
  for (const char* table : {"exam", "sweep", "sweep_end", "frame", "pixels", "pose"}) {
    std::string error;
    execute(file, std::string("UPDATE ") + table + " SET rowid = rowid + 1000", &error);
    EXPECT_NE(error.find("only ever added"), std::string::npos) << table << error;
    execute(file, std::string("DELETE FROM ") + table, &error);
    EXPECT_NE(error.find("only ever added"), std::string::npos) << table << error;
  }
  EXPECT_EQ(differences(file, 1, 1, 3), std::vector<std::string>{});
}

TEST(Exam, ReviewKeepsEveryVersionAndShowsTheNewest) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "e.exam";
  ExamWriter writer = ExamWriter::create(file, "e");
  EXPECT_EQ(writer.add_review({.object = "a", .kind = ReviewKind::landmark, .json = R"({"x":1})", .png = {}}),
            1);
  EXPECT_EQ(writer.add_review({.object = "b", .kind = ReviewKind::snapshot, .json = "{}", .png = {1, 2, 3}}),
            1);
  EXPECT_EQ(writer.add_review({.object = "a", .kind = ReviewKind::landmark, .json = R"({"x":2})", .png = {}}),
            2);
  EXPECT_EQ(writer.add_review({.object = "c", .kind = ReviewKind::plane, .json = "{}", .png = {}}), 1);
  EXPECT_EQ(
      writer.add_review({.object = "c", .kind = ReviewKind::plane, .removed = true, .json = "{}", .png = {}}),
      2);
  std::vector<std::string> damage;
  const ExamReader reader(file);
  const std::vector<ReviewObject> now = reader.review(damage);
  ASSERT_EQ(now.size(), 2u);
  EXPECT_EQ(now[0].json, R"({"x":2})");
  EXPECT_EQ(now[0].version, 2);
  EXPECT_EQ(now[1].png, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(now[1].kind, ReviewKind::snapshot);
  EXPECT_EQ(reader.review(damage, true).size(), 5u);
  EXPECT_EQ(damage, std::vector<std::string>{});
}

TEST(Exam, ReadsWhileItIsWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "e.exam";
  MadeSweep sweep(16, 16, 20, 4);
  ExamWriter writer = ExamWriter::create(file, "e");
  writer.begin_sweep(1, test::small_setup(16, 16));
  const ExamReader reader(file);
  for (std::int64_t i = 0; i < 20; ++i) {
    const FrameRecord f = sweep.frame(i);
    writer.append(1, {&f, 1}, {});
    ASSERT_EQ(static_cast<std::int64_t>(reader.frames(1).frames.size()), i + 1);
    if (i == 10) writer.checkpoint(false);
  }
}

TEST(Exam, OldSchemasMoveOnAndNewerOnesAreSaid) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 2);
  std::vector<std::string> steps(migrations().begin(), migrations().end());
  steps.push_back("CREATE TABLE later(id INTEGER PRIMARY KEY)");
  {
    Database database(file, Database::Mode::write);
    EXPECT_FALSE(up_to_date(database, steps));
    migrate(database, steps);
    EXPECT_TRUE(up_to_date(database, steps));
    EXPECT_EQ(database.integer("SELECT count(*) FROM later"), 0);
    EXPECT_EQ(database.integer("SELECT count(*) FROM frame"), 2);
  }
  try {
    const ExamReader reader(file);
    FAIL() << "opened a newer schema";
  } catch (const StoreError& e) {
    EXPECT_EQ(e.kind(), StoreError::Kind::newer);
    EXPECT_NE(std::string(e.what()).find("newer Sonoband"), std::string::npos);
  }
  // A step that fails leaves the file as it was.
  const std::filesystem::path second = folder.path() / "second.exam";
  ExamWriter::create(second, "second").close();
  steps.back() = "CREATE TABLE half(id INTEGER); CREATE TABLE exam(id)";
  Database database(second, Database::Mode::write);
  EXPECT_THROW(migrate(database, steps), StoreError);
  EXPECT_EQ(database.integer("SELECT count(*) FROM sqlite_schema WHERE name = 'half'"), 0);
  EXPECT_EQ(database.integer("PRAGMA user_version"), 1);
}

TEST(Exam, OtherFilesAreNotExams) {
  const TemporaryFolder folder;
  const std::filesystem::path other = folder.path() / "other.exam";
  execute(other, "CREATE TABLE t(x)");
  EXPECT_THROW(ExamReader{other}, StoreError);
  const std::filesystem::path text = folder.path() / "text.exam";
  std::ofstream(text) << std::string(5000, 'x');
  EXPECT_THROW(ExamReader{text}, StoreError);
  EXPECT_THROW(ExamReader{folder.path() / "none.exam"}, StoreError);
}

TEST(ExamFolder, ListsFromTheIndexAndWithoutIt) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 5);
  const ExamFolder exams(folder.path(), ExamFolder::Use::look);
  const auto check = [&] {
    const std::vector<ExamSummary> all = exams.list();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].id, "20260102-030405-aaaa");
    EXPECT_EQ(all[0].frames, 5);
    EXPECT_EQ(all[0].sweeps, 1);
    EXPECT_EQ(all[0].path, file.string());
    EXPECT_EQ(all[0].damage, "");
  };
  check();
  ASSERT_TRUE(std::filesystem::exists(folder.path() / "index.sqlite"));
  check();
  std::ofstream(folder.path() / "index.sqlite") << "not an index any more";
  check();
  std::filesystem::remove(folder.path() / "index.sqlite");
  check();
  EXPECT_EQ(exams.find("20260102"), file);
  EXPECT_EQ(exams.find(file.string()), file);
  EXPECT_THROW(exams.find("2027"), StoreError);
  // A change of the exam shows although the index is there.
  ExamWriter::open(file).set_label("somebody");
  EXPECT_EQ(exams.list()[0].label, "somebody");
}

TEST(ExamFolder, HasOneCartAtATime) {
  const TemporaryFolder folder;
  const ExamFolder first(folder.path(), ExamFolder::Use::cart);
  EXPECT_THROW(ExamFolder(folder.path(), ExamFolder::Use::cart), StoreError);
  const ExamFolder beside(folder.path(), ExamFolder::Use::look);
}

TEST(ExamFolder, KeepsAReserve) {
  const TemporaryFolder folder;
  const Room plenty = room_left(folder.path(), 0, 1e6);
  ASSERT_GT(plenty.free_bytes, 0);
  EXPECT_TRUE(plenty.may_start);
  EXPECT_NEAR(plenty.minutes, static_cast<double>(plenty.free_bytes) / 60e6, 0.01 * plenty.minutes);
  const Room none = room_left(folder.path(), plenty.free_bytes * 2, 1e6);
  EXPECT_FALSE(none.may_start);
  EXPECT_EQ(none.minutes, 0);
  EXPECT_NE(none.sentence, "");
  EXPECT_FALSE(room_left(folder.path() / "gone", 0, 1e6).may_start);
}

TEST(SweepLoader, ShowsTheFirstPictureBeforeTheRest) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 60);
  SweepLoader loader(file, 1, 33);
  EXPECT_TRUE(loader.ready(33));
  Pixels made(40, 24);
  test::paint(33, 1, made.view());
  EXPECT_EQ(loader.frame(33).bscan.pixels(7, 11), made.view()(7, 11));
  loader.wait();
  EXPECT_TRUE(loader.done());
  EXPECT_EQ(loader.total(), 60);
  EXPECT_EQ(loader.damage(), std::vector<std::string>{});
  EXPECT_EQ(loader.renderable().size(), 48u);  // each fifth has no pose
  TrackedFrame expected;
  set_pose(expected, test::record(7, 1, {}).world_from_image);
  EXPECT_EQ(loader.frame(7).image_from_world.linear, expected.image_from_world.linear);
  EXPECT_EQ(loader.frame(7).image_from_world.translation, expected.image_from_world.translation);
  EXPECT_EQ(loader.mask().width, 40);
}

TEST(SweepLoader, RefusesMoreThanTheMemoryItMayHave) {
  const TemporaryFolder folder;
  const std::filesystem::path file = recorded(folder, 60);
  EXPECT_THROW(SweepLoader(file, 1, 0, 40 * 24 * 59), StoreError);
  EXPECT_NO_THROW(SweepLoader(file, 1, 0, 40 * 24 * 60));
  EXPECT_THROW(SweepLoader(file, 2), StoreError);
}

}  // namespace
}  // namespace sonoband::exam
