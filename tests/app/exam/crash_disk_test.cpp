// The promise of app/exam/README.md on disks that fill up, go away or lose power at any change.
// SONOBAND_CRASH_MOMENTS set: every change; tools/crash-tests writes the README's table from the lines that
// begin with "crash-table".
#include <gtest/gtest.h>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/journal.h"
#include "app/exam/recorder.h"
#include "tests/app/exam/crash_support.h"
#include "tests/app/exam/faulty_disk.h"

namespace sonoband::exam {
namespace {

namespace fs = std::filesystem;
using Fault = test::FaultyDisk::Fault;
using State = RecorderStatus::State;
using test::Acknowledged;
using test::broken_promises;
using test::differences;
using test::eventually;
using test::FaultyDisk;
using test::MadeSweep;
using test::moments;
using test::record_script;
using test::script_frames;
using test::stride;
using test::table_row;
using test::TemporaryFolder;

constexpr int width = test::script_width;
constexpr int height = test::script_height;

TEST(Crash, DiskFullOrGoneAtEveryChange) {
  const TemporaryFolder folder;
  const fs::path fresh = folder.path() / "fresh.exam";
  ExamWriter::create(fresh, "fresh").close();
  const MadeSweep sweep(width, height, script_frames, 1);
  const fs::path file = folder.path() / "e.exam";
  std::int64_t times = 0;
  std::int64_t lost = 0;
  for (const Fault fault : {Fault::full, Fault::gone}) {
    for (std::int64_t n = 0;; n += stride()) {
      fs::copy_file(fresh, file, fs::copy_options::overwrite_existing);
      FaultyDisk disk(1);
      disk.fail_at(n, fault);
      Acknowledged done;
      bool failed = false;
      try {
        record_script(file, disk.name(), sweep, done);
      } catch (const StoreError& e) {
        failed = true;
        EXPECT_EQ(e.kind(), fault == Fault::full ? StoreError::Kind::full : e.kind());
      }
      if (disk.changes() <= n) break;  // it never came to that change
      ++times;
      disk.heal();
      const std::vector<std::string> wrong = broken_promises(file, done);
      EXPECT_EQ(wrong, std::vector<std::string>{}) << "change " << n;
      // With the disk back the rest goes in as well.
      const std::int64_t reviews = done.reviews;
      Acknowledged again;
      if (failed) record_script(file, disk.name(), sweep, again);
      again.frames = script_frames;
      again.reviews = reviews;
      const std::vector<std::string> after = broken_promises(file, again);
      EXPECT_EQ(after, std::vector<std::string>{}) << "after change " << n;
      lost += !wrong.empty() || !after.empty();
      for (const char* end : {"-wal", "-shm"}) fs::remove(file.string() + end);
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(times, 100 / stride());
  table_row("disk full or gone at every change (write, truncation, sync), then back", times,
            lost == 0 ? "nothing acknowledged lost, nothing doubled" : "LOST " + std::to_string(lost));
}

TEST(Crash, PowerCutAtEveryChange) {
  const TemporaryFolder folder;
  const fs::path fresh = folder.path() / "fresh.exam";
  ExamWriter::create(fresh, "fresh").close();
  const MadeSweep sweep(width, height, script_frames, 1);
  const fs::path file = folder.path() / "e.exam";
  const int rounds = moments(0) / 250 + 1;
  std::int64_t times = 0;
  std::int64_t lost = 0;
  std::int64_t torn = 0;
  for (int round = 0; round < rounds; ++round) {
    for (std::int64_t n = 0;; n += stride()) {
      fs::copy_file(fresh, file, fs::copy_options::overwrite_existing);
      FaultyDisk disk(static_cast<std::uint64_t>(n) + 1000U * static_cast<unsigned>(round));
      disk.fail_at(n, Fault::power);
      Acknowledged done;
      try {
        record_script(file, disk.name(), sweep, done);
      } catch (const StoreError&) {
      }
      if (disk.changes() <= n) break;
      ++times;
      disk.cut_power();
      const JournalState journal = journal_state(file);
      EXPECT_FALSE(journal.damaged) << "change " << n;  // a power cut tears, it does not damage
      torn += journal.torn;
      std::string sentence;
      try {
        sentence = recover_exam(file);
      } catch (const StoreError& e) {
        ADD_FAILURE() << "change " << n << ": " << e.what();
      }
      const std::vector<std::string> wrong = broken_promises(file, done);
      EXPECT_EQ(wrong, std::vector<std::string>{}) << "change " << n << ": " << sentence;
      if (done.sweep && !done.ended) {
        EXPECT_NE(sentence.find("cut off"), std::string::npos);
      }
      lost += !wrong.empty();
      EXPECT_EQ(recover_exam(file), "");  // once is enough
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(times, 100 / stride());
  EXPECT_GT(torn, 0);  // or the disk was too kind
  table_row("power cut at every change, unsynced writes kept at random", times,
            (lost == 0 ? "nothing acknowledged lost; " : "LOST " + std::to_string(lost) + "; ") +
                std::to_string(torn) + " torn journals told as such");
}

// A file system of its own that is full in the midst of recording: first the exam itself, then each batch.
TEST(Crash, SmallDiskFullWhileRecording) {
  std::int64_t times = 0;
  for (std::int64_t kib = 400; kib <= 1600; kib += 400 / (8 / stride() + 1)) {
    ++times;
    test::on_small_disk(kib << 10, [](const fs::path& place) {
      const fs::path file = place / "e.exam";
      RecorderSettings settings;
      settings.batch = std::chrono::milliseconds(3);
      settings.retry = std::chrono::milliseconds(10);
      settings.goodbye = std::chrono::milliseconds(50);
      settings.reserve_bytes = 0;
      settings.journal_bytes = 300'000;
      settings.new_id = "small";
      std::int64_t stored = 0;
      {
        Recorder recorder(file, settings);
        const auto sweep = std::make_shared<MadeSweep>(160, 100, 200, 1);
        recorder.begin(sweep, test::small_setup(160, 100));
        for (std::int64_t i = 10; i <= 200; i += 10) {
          sweep->publish(i);
          std::this_thread::sleep_for(std::chrono::milliseconds(3));
        }
        ASSERT_TRUE(eventually([&] { return recorder.status().state == State::full; }));
        stored = recorder.status().stored;
        sweep->finish();
      }
      if (stored > 0) {
        EXPECT_TRUE(fs::exists(file));
      }
      const ExamFolder exams(place, ExamFolder::Use::look);
      for (const ExamSummary& e : exams.list()) {
        EXPECT_EQ(e.damage, "");
        EXPECT_GE(e.frames, stored);
        if (e.sweeps > 0) {
          EXPECT_EQ(differences(file, 1, 1, stored), std::vector<std::string>{});
        }
      }
    });
    if (testing::Test::HasFailure()) return;
  }
  table_row("a file system of 400 to 1600 KiB full while recording", times,
            "nothing acknowledged lost, told as full");
}

TEST(Crash, RecorderOutlivesAFullAndAPulledDisk) {
  const MadeSweep made(width, height, 60, 1);
  for (const Fault fault : {Fault::full, Fault::gone}) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "e.exam";
    ExamWriter::create(file, "e").close();
    FaultyDisk disk(1);
    RecorderSettings settings;
    settings.batch = std::chrono::milliseconds(3);
    settings.retry = std::chrono::milliseconds(5);
    settings.reserve_bytes = 0;
    settings.vfs = disk.name();
    {
      Recorder recorder(file, settings);
      const auto sweep = std::make_shared<MadeSweep>(width, height, 60, 1);
      sweep->publish(20);
      recorder.begin(sweep, test::small_setup(width, height));
      ASSERT_TRUE(eventually([&] { return recorder.status().stored == 20; }));
      for (int round = 0; round < 3; ++round) {
        disk.fail_at(2 * round, fault);
        sweep->publish(30 + 10 * round);
        const State expected = fault == Fault::full ? State::full : State::failing;
        ASSERT_TRUE(eventually([&] { return recorder.status().state == expected; }));
        EXPECT_NE(recorder.status().sentence, "");
        EXPECT_LT(recorder.status().stored, 30 + 10 * round);
        disk.heal();
        ASSERT_TRUE(eventually([&] { return recorder.status().stored == 30 + 10 * round; }));
        EXPECT_EQ(recorder.status().state, State::recording);
        EXPECT_EQ(recorder.status().sentence, "");
      }
      sweep->publish(60);
      sweep->finish();
    }
    EXPECT_EQ(differences(file, 1, 1, 60), std::vector<std::string>{});
  }
}

}  // namespace
}  // namespace sonoband::exam
