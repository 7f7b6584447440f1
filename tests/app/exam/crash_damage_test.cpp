// Damage at random places of an exam's files is found, named and contained. SONOBAND_CRASH_MOMENTS says how
// often it is tried; tools/crash-tests writes the README's table from the lines that begin with
// "crash-table".
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/journal.h"
#include "tests/app/exam/crash_support.h"

namespace sonoband::exam {
namespace {

namespace fs = std::filesystem;
using test::Acknowledged;
using test::broken_promises;
using test::MadeSweep;
using test::moments;
using test::note;
using test::record_script;
using test::script_frames;
using test::table_row;
using test::TemporaryFolder;

constexpr int width = test::script_width;
constexpr int height = test::script_height;

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
