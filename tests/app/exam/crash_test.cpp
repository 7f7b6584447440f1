// The promise of app/exam/README.md, broken into at every moment. SONOBAND_CRASH_MOMENTS says how often the
// random ones are tried (a few by default, hundreds in tools/crash-tests, which writes the README's table
// from the lines that begin with "crash-table").
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "app/cart_on_board.h"
#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/journal.h"
#include "app/exam/recorder.h"
#include "tests/app/exam/exam_support.h"
#include "tests/app/exam/faulty_disk.h"

namespace sonoband::exam {
namespace {

namespace fs = std::filesystem;
using Fault = test::FaultyDisk::Fault;
using State = RecorderStatus::State;
using test::differences;
using test::eventually;
using test::FaultyDisk;
using test::MadeSweep;
using test::TemporaryFolder;

int moments(int by_default) {
  const char* asked = std::getenv("SONOBAND_CRASH_MOMENTS");
  return asked == nullptr ? by_default : std::atoi(asked);
}

// How many changes of the disk to step on; the whole table takes every one.
int stride() {
  return std::getenv("SONOBAND_CRASH_MOMENTS") == nullptr ? 5 : 1;
}

void table_row(const std::string& fault, std::int64_t times, const std::string& found) {
  std::printf("crash-table | %s | %lld | %s |\n", fault.c_str(), static_cast<long long>(times),
              found.c_str());
}

constexpr int width = 48;
constexpr int height = 32;

// What was acknowledged by the time of the crash.
struct Acknowledged {
  bool sweep = false;
  std::int64_t frames = 0;
  std::int64_t reviews = 0;
  bool ended = false;
};

ReviewObject note(std::int64_t number) {
  return {.object = "note" + std::to_string(number),
          .kind = ReviewKind::note,
          .json = "{\"number\":" + std::to_string(number) + "}",
          .png = {}};
}

constexpr std::int64_t script_frames = 18;

// One sweep in six batches with review between them; goes on from what is in the file, as the recorder does.
void record_script(const fs::path& file, const std::string& vfs, const MadeSweep& sweep, Acknowledged& done) {
  ExamWriter writer = ExamWriter::open(file, vfs);
  writer.begin_sweep(1, test::small_setup(width, height));
  done.sweep = true;
  done.frames = writer.stored_frames(1);
  while (done.frames < script_frames) {
    std::vector<FrameRecord> batch;
    std::vector<PoseSample> poses;
    for (std::int64_t i = done.frames; i < std::min(done.frames + 3, script_frames); ++i) {
      batch.push_back(sweep.frame(i));
      for (std::int64_t p = 4 * i; p < 4 * i + 4; ++p) poses.push_back(test::reading(p, 1));
    }
    writer.append(1, batch, poses);
    done.frames += static_cast<std::int64_t>(batch.size());
    if (done.frames == 6 || done.frames == 12) {
      writer.add_review(note(done.reviews));
      ++done.reviews;
    }
    if (done.frames == 9) writer.checkpoint(false);
  }
  writer.end_sweep(1, script_frames, sweep.ledger());
  done.ended = true;
  writer.checkpoint(true);
  writer.close();
}

// Sentences about what was acknowledged and is not there.
std::vector<std::string> broken_promises(const fs::path& file, const Acknowledged& done) {
  std::vector<std::string> wrong;
  try {
    const ExamReader reader(file);
    wrong = reader.verify().damage;
    const std::vector<SweepSummary> sweeps = reader.sweeps();
    if (done.sweep && sweeps.empty()) wrong.push_back("the sweep is gone");
    if (done.ended && (sweeps.empty() || !sweeps[0].ended || sweeps[0].ledger.empty()))
      wrong.push_back("the sweep's end is gone");
    if (!sweeps.empty()) {
      for (std::string& s : differences(file, 1, 1, done.frames)) wrong.push_back(std::move(s));
    }
    std::vector<std::string> damage;
    if (static_cast<std::int64_t>(reader.review(damage).size()) < done.reviews)
      wrong.push_back("a note is gone");
  } catch (const StoreError& e) {
    wrong.push_back(e.what());
  }
  return wrong;
}

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

// Shared with a child that will be killed.
struct Diary {
  std::atomic<std::int64_t> acknowledged{0};  // frames
  std::atomic<std::int64_t> reviews{0};
  std::atomic<std::int64_t> published{0};
  std::atomic<std::int64_t> published_ns[4096];  // when each frame was, over all sweeps
};

constexpr std::int64_t frames_of_a_sweep = 40;

[[noreturn]] void record_until_killed(const fs::path& file, Diary& diary) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
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
  void* shared = ::mmap(nullptr, sizeof(Diary), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
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
    Diary& diary = *::new (shared) Diary;
    const fs::path file = folder.path() / ("20260101-000000-" + std::to_string(1000 + i) + ".exam");
    std::fflush(nullptr);
    const ::pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) record_until_killed(file, diary);
    // Mostly in the midst of recording, sometimes while the exam is being made.
    if (i % 4 != 0) {
      EXPECT_TRUE(eventually([&] { return diary.published > 0; }));
    }
    ::usleep(static_cast<::useconds_t>(random() % 80'000));
    ::kill(child, SIGKILL);
    const std::int64_t killed = std::chrono::steady_clock::now().time_since_epoch().count();
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << status;
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
  ::munmap(shared, sizeof(Diary));
  table_row("kill -9 while recording and reviewing (batches of 5 ms)", count,
            (lost == 0 ? "nothing acknowledged lost of " : "LOST " + std::to_string(lost) + " of ") +
                std::to_string(frames) + " frames; the oldest frame lost was " +
                std::to_string(oldest_lost_us / 1000) + " ms old");
}

// A whole cart on the machine's own clock: press, sweep, release, press again, until it is killed.
[[noreturn]] void examine_until_killed(const fs::path& place, Diary& diary) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  Profile profile;
  profile.capture.rate_hz = 60;
  profile.capture.crop_px = {200, 100, 160, 120};
  profile.ring.frames = 300;
  profile.ring.pre_roll_s = 0.2;
  profile.exams.reserve_mb = 0;
  const auto clock = std::make_shared<SystemClock>();
  BoardDevices board = make_sim_board(profile, *clock);
  const auto cart = make_appliance(board, profile, clock, place);
  cart->start();
  bool down = false;
  for (int i = 0;; ++i) {
    if (i % 60 == 20 || i % 60 == 55) board.foot(down = !down);
    while (cart->take_sweep()) {
    }
    const cart::ApplianceStatus& status = cart->status();
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
  void* shared = ::mmap(nullptr, sizeof(Diary), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  std::int64_t lost = 0;
  std::int64_t frames = 0;
  int cut_off = 0;
  std::int64_t longest_unsaved_ms = 0;
  for (int i = 0; i < count; ++i) {
    Diary& diary = *::new (shared) Diary;
    const fs::path place = folder.path() / std::to_string(i);
    std::fflush(nullptr);
    const ::pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) examine_until_killed(place, diary);
    EXPECT_TRUE(eventually([&] { return diary.published > 0; }));
    ::usleep(static_cast<::useconds_t>(random() % 700'000));
    ::kill(child, SIGKILL);
    const std::int64_t killed = std::chrono::steady_clock::now().time_since_epoch().count();
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << status;
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
  ::munmap(shared, sizeof(Diary));
  EXPECT_GT(cut_off, 0);
  table_row("kill -9 of a recording simulated cart, 60 frames a second, batches of 250 ms", count,
            (lost == 0 ? "nothing acknowledged lost of " : "LOST " + std::to_string(lost) + " of ") +
                std::to_string(frames) + " frames; the oldest frame lost had been known " +
                std::to_string(longest_unsaved_ms) + " ms; " + std::to_string(cut_off) +
                " exams cut off and recovered");
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

// An exam of two sweeps and a note; `journal` leaves it as a crash would.
void write_victim(const fs::path& file, bool journal) {
  std::unique_ptr<ExamWriter> writer;
  writer = std::make_unique<ExamWriter>(ExamWriter::create(file, "victim"));
  for (std::int64_t s = 1; s <= 2; ++s) {
    MadeSweep sweep(width, height, 30, static_cast<std::uint64_t>(s));
    sweep.publish(30);
    writer->begin_sweep(s, test::small_setup(width, height));
    for (std::int64_t at = 0; at < 30; at += 5) {
      std::vector<FrameRecord> batch;
      for (std::int64_t i = at; i < at + 5; ++i) batch.push_back(sweep.frame(i));
      std::vector<PoseSample> poses(20);
      sweep.take_poses(poses);
      writer->append(s, batch, poses);
    }
    writer->end_sweep(s, 30, sweep.ledger());
  }
  writer->set_label("a label");
  writer->add_review(note(1));
  if (!journal) {
    writer->close();
    return;
  }
  // Copies made while the writer still has it: its last close would empty the journal.
  const fs::path aside = file.string() + ".aside";
  fs::copy_file(file, aside);
  fs::copy_file(file.string() + "-wal", aside.string() + "-wal");
  writer.reset();
  for (const char* end : {"", "-wal", "-shm"}) fs::remove(file.string() + end);
  fs::rename(aside, file);
  fs::rename(aside.string() + "-wal", file.string() + "-wal");
}

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

// What of the victim can be read, and whether all of it is right. Wrong pictures are never given.
struct Readable {
  std::int64_t frames = 0;
  bool all = false;
  bool damage_told = false;
  std::vector<std::string> wrong;
};
Readable read_victim(const fs::path& file) {
  Readable r;
  try {
    const ExamReader reader(file);
    const ExamReader::Verification v = reader.verify();
    r.damage_told = !v.damage.empty();
    Pixels made(width, height);
    Pixels read(width, height);
    for (std::int64_t s = 1; s <= 2; ++s) {
      try {
        for (const StoredFrame& f : reader.frames(s).frames) {
          if (!reader.pixels(s, f, read.view()).empty()) continue;
          test::paint(f.record.number, static_cast<std::uint64_t>(s), made.view());
          const FrameRecord e = test::record(f.record.number, static_cast<std::uint64_t>(s), {});
          if (!std::equal(made.view().data, made.view().data + width * height, read.view().data) ||
              f.record.captured != e.captured || f.record.pose_status != e.pose_status ||
              f.record.world_from_image.linear != e.world_from_image.linear)
            r.wrong.push_back("sweep " + std::to_string(s) + ", frame " + std::to_string(f.record.number));
          ++r.frames;
        }
      } catch (const StoreError&) {
        r.damage_told = true;
      }
    }
    std::vector<std::string> damage;
    r.all = r.frames == 60 && v.poses == 240 && reader.review(damage).size() == 1 &&
            reader.summary().label == "a label";
  } catch (const StoreError&) {
    r.damage_told = true;
  }
  return r;
}

TEST(Crash, DamageIsFoundNamedAndContained) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "20260101-000000-0001.exam";
  write_victim(file, false);
  const std::string good = contents(file);
  Acknowledged whole;
  const fs::path other = folder.path() / "20260101-000000-0002.exam";
  ExamWriter::create(other, "20260101-000000-0002").close();
  record_script(other, {}, MadeSweep(width, height, script_frames, 1), whole);
  ASSERT_TRUE(read_victim(file).all);

  std::mt19937_64 random(3);
  const int count = moments(40);
  std::int64_t told = 0;
  std::int64_t harmless = 0;
  std::int64_t saved = 0;
  for (int i = 0; i < count; ++i) {
    std::string bad = good;
    const std::size_t at = random() % bad.size();
    if (i % 4 == 3) {
      bad.resize(at);
    } else {
      for (std::size_t k = 0; k < 1 + random() % 8 && at + k < bad.size(); ++k)
        bad[at + k] = static_cast<char>(bad[at + k] ^ (1 << random() % 8));
    }
    for (const char* end : {"-wal", "-shm"}) fs::remove(file.string() + end);
    put(file, bad);
    const Readable r = read_victim(file);
    EXPECT_EQ(r.wrong, std::vector<std::string>{}) << "gave wrong pictures after damage at " << at;
    EXPECT_TRUE(r.damage_told || r.all)
        << "silent loss after damage at " << at << (i % 4 == 3 ? " (cut)" : "");
    told += r.damage_told;
    harmless += !r.damage_told && r.all;
    saved += r.frames;
    const std::vector<ExamSummary> all = ExamFolder(folder.path(), ExamFolder::Use::look).list();
    EXPECT_EQ(all.size(), 2u);
    EXPECT_EQ(all.front().damage, "") << "reached the other exam";
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(broken_promises(other, whole), std::vector<std::string>{});
  EXPECT_GT(told, count / 3);
  table_row("bits flipped or file cut at random places of an exam", count,
            "told " + std::to_string(told) + ", in unused bytes " + std::to_string(harmless) +
                ", silent or wrong 0; still readable: " + std::to_string(saved * 100 / (60LL * count)) +
                " % of the frames; the other exam untouched");
}

TEST(Crash, DamageOfTheJournalIsTold) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "20260101-000000-0001.exam";
  const fs::path journal = file.string() + "-wal";
  write_victim(file, true);
  const std::string good = contents(file);
  const std::string good_journal = contents(journal);
  ASSERT_GT(good_journal.size(), 100'000u);
  EXPECT_FALSE(journal_state(file).damaged);
  EXPECT_FALSE(journal_state(file).torn);
  EXPECT_GE(journal_state(file).commits, 16);

  std::mt19937_64 random(5);
  const int count = moments(20);
  std::int64_t told = 0;
  for (int i = 0; i < count; ++i) {
    std::string bad = good_journal;
    const std::size_t at = random() % bad.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << random() % 8));
    fs::remove(file.string() + "-shm");
    put(file, good);
    put(journal, bad);
    std::string sentence;
    try {
      sentence = recover_exam(file);
    } catch (const StoreError& e) {
      sentence = std::string(e.what()) + " damaged";
    }
    const Readable r = read_victim(file);
    EXPECT_EQ(r.wrong, std::vector<std::string>{});
    const bool said =
        sentence.find("damaged") != std::string::npos || sentence.find("not complete") != std::string::npos;
    EXPECT_TRUE(said || r.all) << "silent loss after damage at " << at << ": " << sentence;
    told += said;
  }
  EXPECT_GT(told, count / 2);
  table_row(
      "a bit flipped at random places of an interrupted journal", count,
      "told " + std::to_string(told) + ", harmless " + std::to_string(count - told) + ", silent or wrong 0");
}

}  // namespace
}  // namespace sonoband::exam
