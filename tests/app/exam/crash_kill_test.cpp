// The promise of app/exam/README.md when the process is killed at any moment. SONOBAND_CRASH_MOMENTS says how
// often it is tried; tools/crash-tests writes the README's table from the lines that begin with
// "crash-table".
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <random>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/recorder.h"
#include "tests/app/exam/crash_support.h"

namespace sonoband::exam {
namespace {

namespace fs = std::filesystem;
using test::Acknowledged;
using test::broken_promises;
using test::differences;
using test::eventually;
using test::MadeSweep;
using test::moments;
using test::note;
using test::record_script;
using test::script_frames;
using test::table_row;
using test::TemporaryFolder;

constexpr int width = test::script_width;
constexpr int height = test::script_height;

// Shared with a child that will be killed.
struct Diary {
  std::atomic<std::int64_t> acknowledged{0};  // frames
  std::atomic<std::int64_t> reviews{0};
  std::atomic<std::int64_t> published{0};
  std::atomic<std::int64_t> published_ns[4096];  // when each frame was, over all sweeps
};

constexpr std::int64_t frames_of_a_sweep = 40;

[[noreturn]] void record_until_killed(const fs::path& file, Diary& diary) {
  ExamWriter::create(file, file.stem().string()).close();
  RecorderSettings settings;
  settings.batch = std::chrono::milliseconds(5);
  settings.reserve_bytes = 0;
  settings.journal_bytes = 100'000;
  Recorder recorder(file, settings);
  const auto look = [&] {
    const RecorderStatus status = recorder.status();
    diary.acknowledged = status.stored;
    diary.reviews = static_cast<std::int64_t>(status.reviews_saved);
  };
  for (std::uint64_t s = 1;; ++s) {
    const auto sweep = std::make_shared<MadeSweep>(width, height, frames_of_a_sweep, s);
    recorder.begin(sweep, test::small_setup(width, height));
    for (std::int64_t i = 1; i <= frames_of_a_sweep; ++i) {
      diary.published_ns[diary.published % 4096] =
          std::chrono::steady_clock::now().time_since_epoch().count();
      ++diary.published;
      sweep->publish(i);
      look();
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
    sweep->finish();
    recorder.save_now();
    recorder.add_review(note(static_cast<std::int64_t>(s)));
    look();
  }
}

TEST(Crash, KilledAtRandomMoments) {
  const TemporaryFolder folder;
  const int count = moments(20);
  std::mt19937_64 random(7);
  test::SharedDiary<Diary> shared;
  // An earlier exam, to see that nothing happens to it.
  const fs::path earlier = folder.path() / "19990101-000000-0000.exam";
  Acknowledged whole;
  {
    ExamWriter::create(earlier, "earlier").close();
    const MadeSweep sweep(width, height, script_frames, 1);
    record_script(earlier, {}, sweep, whole);
  }
  std::int64_t lost = 0;
  std::int64_t frames = 0;
  std::int64_t oldest_lost_us = 0;
  for (int i = 0; i < count; ++i) {
    Diary& diary = shared.blank();
    const fs::path file = folder.path() / ("20260101-000000-" + std::to_string(1000 + i) + ".exam");
    const ::pid_t child = test::start_child([&] { record_until_killed(file, diary); });
    // Mostly in the midst of recording, sometimes while the exam is being made.
    if (i % 4 != 0) {
      EXPECT_TRUE(eventually([&] { return diary.published > 0; }));
    }
    ::usleep(static_cast<::useconds_t>(random() % 80'000));
    const std::int64_t killed = test::kill_child(child);
    const ExamFolder exams(folder.path(), ExamFolder::Use::cart);  // the next start
    EXPECT_LE(exams.recovered().size(), 1u);
    std::int64_t found = 0;
    if (fs::exists(file)) {
      std::vector<std::string> wrong = ExamReader(file).verify().damage;
      for (const SweepSummary& s : ExamReader(file).sweeps()) {
        found += s.frames;
        EXPECT_TRUE(s.ended);
        for (std::string& sentence : differences(file, s.id, static_cast<std::uint64_t>(s.id), s.frames))
          wrong.push_back(std::move(sentence));
      }
      std::vector<std::string> damage;
      const std::int64_t reviews = static_cast<std::int64_t>(ExamReader(file).review(damage).size());
      EXPECT_GE(reviews, diary.reviews);
      EXPECT_EQ(wrong, std::vector<std::string>{});
      lost += !wrong.empty() || reviews < diary.reviews;
    } else {
      EXPECT_EQ(diary.published, 0);  // it had no name yet
    }
    EXPECT_GE(found, diary.acknowledged);
    lost += found < diary.acknowledged;
    frames += found;
    if (found < diary.published && diary.published <= 4096)
      oldest_lost_us = std::max(oldest_lost_us, (killed - diary.published_ns[found]) / 1000);
    if (testing::Test::HasFailure()) return;
    for (const char* end : {"", "-wal", "-shm"}) fs::remove(file.string() + end);
  }
  EXPECT_EQ(broken_promises(earlier, whole), std::vector<std::string>{});
  table_row("kill -9 while recording and reviewing (batches of 5 ms)", count,
            (lost == 0 ? "nothing acknowledged lost of " : "LOST " + std::to_string(lost) + " of ") +
                std::to_string(frames) + " frames; the oldest frame lost was " +
                std::to_string(oldest_lost_us / 1000) + " ms old");
}

// A whole cart on the machine's own clock: press, sweep, release, press again, until it is killed.
[[noreturn]] void examine_until_killed(const fs::path& place, Diary& diary) {
  test::SmallCart small(place, 300);
  bool down = false;
  for (int i = 0;; ++i) {
    if (i % 60 == 20 || i % 60 == 55) small.board.foot(down = !down);
    while (small.cart->take_sweep()) {
    }
    const cart::ApplianceStatus& status = small.cart->status();
    diary.acknowledged = status.saving->stored;
    for (std::int64_t n = diary.published; n < status.saving->published; ++n)
      diary.published_ns[n % 4096] = std::chrono::steady_clock::now().time_since_epoch().count();
    diary.published = status.saving->published;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

TEST(Crash, CartKilledAtRandomMoments) {
  const TemporaryFolder folder;
  const int count = moments(3) / (std::getenv("SONOBAND_CRASH_MOMENTS") == nullptr ? 1 : 5);
  std::mt19937_64 random(9);
  test::SharedDiary<Diary> shared;
  std::int64_t lost = 0;
  std::int64_t frames = 0;
  int cut_off = 0;
  std::int64_t longest_unsaved_ms = 0;
  for (int i = 0; i < count; ++i) {
    Diary& diary = shared.blank();
    const fs::path place = folder.path() / std::to_string(i);
    const ::pid_t child = test::start_child([&] { examine_until_killed(place, diary); });
    EXPECT_TRUE(eventually([&] { return diary.published > 0; }));
    ::usleep(static_cast<::useconds_t>(random() % 700'000));
    const std::int64_t killed = test::kill_child(child);
    const ExamFolder exams(place, ExamFolder::Use::cart);  // the next start
    cut_off += exams.recovered().empty() ? 0 : 1;
    std::int64_t found = 0;
    for (const ExamSummary& exam : exams.list()) {
      EXPECT_EQ(exam.damage, "");
      const ExamReader::Verification v = ExamReader(exam.path).verify();
      EXPECT_EQ(v.damage, std::vector<std::string>{});
      lost += !v.damage.empty();
      found += exam.frames;
    }
    EXPECT_GE(found, diary.acknowledged);
    lost += found < diary.acknowledged;
    frames += found;
    if (found < diary.published && diary.published <= 4096)
      longest_unsaved_ms =
          std::max<std::int64_t>(longest_unsaved_ms, (killed - diary.published_ns[found]) / 1'000'000);
    if (testing::Test::HasFailure()) return;
    std::error_code none;
    fs::remove_all(place, none);
  }
  EXPECT_GT(cut_off, 0);
  table_row("kill -9 of a recording simulated cart, 60 frames a second, batches of 250 ms", count,
            (lost == 0 ? "nothing acknowledged lost of " : "LOST " + std::to_string(lost) + " of ") +
                std::to_string(frames) + " frames; the oldest frame lost had been known " +
                std::to_string(longest_unsaved_ms) + " ms; " + std::to_string(cut_off) +
                " exams cut off and recovered");
}

}  // namespace
}  // namespace sonoband::exam
