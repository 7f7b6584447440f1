// The recorder's thread: what it is handed becomes durable, in order, whatever the pace.
#include "app/exam/recorder.h"

#include <gtest/gtest.h>

#include "app/exam/exam_reader.h"
#include "app/exam/ring_sweep.h"
#include "core/sweep/frame_ring.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exam {
namespace {

using State = RecorderStatus::State;
using test::differences;
using test::eventually;
using test::MadeSweep;
using test::TemporaryFolder;

RecorderSettings quick() {
  RecorderSettings s;
  s.batch = std::chrono::milliseconds(5);
  s.retry = std::chrono::milliseconds(20);
  s.reserve_bytes = 0;
  return s;
}

std::filesystem::path new_exam(const TemporaryFolder& folder) {
  std::filesystem::path file = folder.path() / "e.exam";
  ExamWriter::create(file, "e").close();
  return file;
}

TEST(Recorder, SavesASweepAsItGrows) {
  const TemporaryFolder folder;
  const std::filesystem::path file = new_exam(folder);
  Recorder recorder(file, quick());
  EXPECT_EQ(recorder.status().state, State::idle);
  const auto sweep = std::make_shared<MadeSweep>(32, 20, 300, 1);
  sweep->publish(5);
  recorder.begin(sweep, test::small_setup(32, 20));
  for (std::int64_t n = 10; n <= 300; n += 29) {
    sweep->publish(n);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  sweep->publish(300);
  ASSERT_TRUE(eventually([&] { return recorder.status().stored == 300; }));
  EXPECT_EQ(recorder.status().state, State::recording);
  EXPECT_EQ(differences(file, 1, 1, 300), std::vector<std::string>{});
  sweep->finish();
  recorder.save_now();
  ASSERT_TRUE(eventually([&] { return recorder.status().state == State::saved; }));
  const RecorderStatus status = recorder.status();
  EXPECT_EQ(status.published, 300);
  EXPECT_EQ(status.stored, 300);
  EXPECT_EQ(status.sweep, 1);
  EXPECT_EQ(status.sentence, "");
  EXPECT_EQ(ExamReader(file).sweeps().at(0).ledger, sweep->ledger());
}

TEST(Recorder, LetsGoOfASweepThatIsSaved) {
  const TemporaryFolder folder;
  Recorder recorder(new_exam(folder), quick());
  auto sweep = std::make_shared<MadeSweep>(16, 16, 3, 1);
  const std::weak_ptr<MadeSweep> watch = sweep;
  sweep->publish(3);
  sweep->finish();
  recorder.begin(std::move(sweep), test::small_setup(16, 16));
  EXPECT_TRUE(eventually([&] { return watch.expired(); }));
}

TEST(Recorder, SavesSweepsAndReviewInOrderAndAtTheEnd) {
  const TemporaryFolder folder;
  const std::filesystem::path file = new_exam(folder);
  {
    RecorderSettings slow = quick();
    slow.batch = std::chrono::seconds(100);  // only press, release and the end may save
    Recorder recorder(file, slow);
    for (std::uint64_t s = 1; s <= 3; ++s) {
      const auto sweep = std::make_shared<MadeSweep>(16, 12, 200, s);
      sweep->publish(200);
      sweep->finish();
      recorder.begin(sweep, test::small_setup(16, 12));
    }
    const std::uint64_t ticket = recorder.add_review(
        {.object = "o", .kind = ReviewKind::note, .json = R"({"text":"seen"})", .png = {}});
    EXPECT_TRUE(eventually([&] { return recorder.status().reviews_saved >= ticket; }));
    const auto last = std::make_shared<MadeSweep>(16, 12, 40, 4);
    recorder.begin(last, test::small_setup(16, 12));
    last->publish(40);
    last->finish();
  }
  for (std::int64_t s = 1; s <= 4; ++s)
    EXPECT_EQ(differences(file, s, static_cast<std::uint64_t>(s), s == 4 ? 40 : 200),
              std::vector<std::string>{});
  EXPECT_TRUE(ExamReader(file).summary().closed);
}

TEST(Recorder, HasNoRoomBelowTheReserve) {
  const TemporaryFolder folder;
  RecorderSettings greedy = quick();
  greedy.reserve_bytes = std::int64_t{1} << 60;
  Recorder recorder(new_exam(folder), greedy);
  EXPECT_FALSE(recorder.has_room());
  EXPECT_EQ(recorder.status().room.minutes, 0);
  EXPECT_NE(recorder.status().room.sentence, "");
  // A press just before that was known is saved all the same.
  const auto sweep = std::make_shared<MadeSweep>(16, 12, 2, 4);
  sweep->publish(2);
  sweep->finish();
  recorder.begin(sweep, test::small_setup(16, 12));
  EXPECT_TRUE(eventually([&] { return recorder.status().stored == 2; }));
}

TEST(Recorder, WaitsForADiskThatIsGoneAndGoesOnWhenItIsBack) {
  const TemporaryFolder folder;
  const std::filesystem::path there = folder.path() / "disk";
  const std::filesystem::path gone = folder.path() / "pulled";
  std::filesystem::create_directory(there);
  const std::filesystem::path file = there / "e.exam";
  ExamWriter::create(file, "e").close();
  Recorder recorder(file, quick());
  const auto sweep = std::make_shared<MadeSweep>(32, 20, 100, 8);
  sweep->publish(60);
  std::filesystem::rename(there, gone);
  recorder.begin(sweep, test::small_setup(32, 20));
  ASSERT_TRUE(eventually([&] { return recorder.status().state == State::failing; }));
  const RecorderStatus status = recorder.status();
  EXPECT_NE(status.sentence.find("stays in memory"), std::string::npos);
  EXPECT_EQ(status.stored, 0);
  EXPECT_EQ(status.published, 60);
  EXPECT_GT(status.oldest_unsaved, Duration{});
  EXPECT_FALSE(std::filesystem::exists(there)) << "made a new exam where the disk was";
  std::filesystem::rename(gone, there);
  sweep->publish(100);
  sweep->finish();
  ASSERT_TRUE(eventually([&] { return recorder.status().state == State::saved; }));
  EXPECT_EQ(differences(file, 1, 8, 100), std::vector<std::string>{});
}

// From the ring itself: pre-roll, frames with and without a pose, one that came after the release, the
// ledger.
TEST(Recorder, SavesASweepOfTheRing) {
  const TemporaryFolder folder;
  const std::filesystem::path file = new_exam(folder);
  FrameRing ring({.width = 32, .height = 20, .slots = 100, .reserve = 10});
  PoseLog readings(1000);
  const auto put = [&](std::int64_t n) {
    RingSlot* slot = ring.claim();
    ASSERT_NE(slot, nullptr);
    test::paint(n, 1, slot->pixels);
    const FrameRecord made = test::record(n, 1, {});
    TrackedFrame& f = slot->frame.tracked;
    f.pose_status = made.pose_status;
    if (made.pose_status == PoseStatus::ok) set_pose(f, made.world_from_image);
    f.captured = made.captured;
    if (made.tracker_from_probe) slot->frame.tracker_from_probe = *made.tracker_from_probe;
    slot->frame.raw = {made.stamped, made.arrived, made.device_ns, made.device_count};
    ring.publish(*slot);
    for (std::int64_t i = 0; i < 4; ++i) readings.add(test::reading(4 * n + i, 1));
  };
  {
    Recorder recorder(file, quick());
    for (std::int64_t n = 0; n < 10; ++n) put(n);
    const Stamp pressed = test::record(3, 1, {}).captured;
    Sweep sweep = ring.begin_sweep(1, pressed, std::chrono::seconds(1));
    ASSERT_TRUE(sweep);
    recorder.begin(std::make_shared<RingSweep>(sweep, &readings), test::small_setup(32, 20));
    for (std::int64_t n = 10; n < 50; ++n) put(n);
    ASSERT_TRUE(eventually([&] { return recorder.status().stored == 50; }));
    const RingSweep other(sweep);
    ASSERT_EQ(other.published(), 50);
    LossLedger ledger;
    ledger.received = 45;
    ledger.lost[static_cast<std::size_t>(LossCause::duplicate)] = 2;
    ring.end_sweep(test::record(44, 1, {}).captured, ledger);
    EXPECT_EQ(other.frame(49).captured, test::record(49, 1, {}).captured);  // asked for before, still there
    EXPECT_EQ(other.published(), 45);
    recorder.save_now();
    ASSERT_TRUE(eventually([&] { return recorder.status().state == State::saved; }));
    EXPECT_EQ(recorder.status().stored, 45);
  }
  const ExamReader reader(file);
  const StoredFrames stored = reader.frames(1);
  ASSERT_EQ(stored.frames.size(), 45u);
  Pixels made(32, 20);
  Pixels read(32, 20);
  for (const StoredFrame& f : stored.frames) {
    const FrameRecord e = test::record(f.record.number, 1, {});
    EXPECT_EQ(f.record.pre_roll, e.pre_roll);
    EXPECT_EQ(f.record.pose_status, e.pose_status);
    ASSERT_EQ(f.record.tracker_from_probe.has_value(), e.tracker_from_probe.has_value());
    if (e.tracker_from_probe) {
      EXPECT_EQ(f.record.tracker_from_probe->rotation, e.tracker_from_probe->rotation);
    }
    EXPECT_EQ(f.record.captured, e.captured);
    EXPECT_EQ(f.record.stamped, e.stamped);
    EXPECT_EQ(f.record.device_count, e.device_count);
    ASSERT_EQ(reader.pixels(1, f, read.view()), "");
    test::paint(f.record.number, 1, made.view());
    ASSERT_TRUE(std::equal(made.view().data, made.view().data + 32 * 20, read.view().data));
  }
  std::vector<std::string> damage;
  EXPECT_EQ(reader.poses(1, damage).size(), 200u);
  const std::vector<Counter> ledger = reader.sweeps().at(0).ledger;
  EXPECT_NE(std::find(ledger.begin(), ledger.end(), Counter{"received", 45}), ledger.end());
  EXPECT_NE(std::find(ledger.begin(), ledger.end(), Counter{"lost_duplicate", 2}), ledger.end());
}

}  // namespace
}  // namespace sonoband::exam
