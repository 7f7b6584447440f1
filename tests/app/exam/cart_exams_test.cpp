// A whole simulated cart that saves what it records: nothing is lost between the ring and the disk, and
// trouble with the disk is told and outlived.
#include "app/exam/cart_exams.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "app/cart_on_board.h"
#include "app/exam/exam_reader.h"
#include "app/exam/sweep_loader.h"
#include "hal/sim/virtual_clock.h"
#include "tests/app/exam/exam_support.h"

namespace sonoband::exam {
namespace {

using State = RecorderStatus::State;
using test::eventually;
using test::TemporaryFolder;

struct Cart {
  explicit Cart(const std::filesystem::path& exams, int reserve_mb = 1) {
    Profile profile;
    profile.exams.reserve_mb = reserve_mb;
    profile.ring.frames = 150;
    profile.ring.pre_roll_s = 0.2;
    profile.capture.crop_px = {200, 100, 160, 120};
    profile.capture.latency_ms = 60;
    board = make_sim_board(profile, *clock);
    appliance = make_appliance(board, profile, clock, exams);
  }

  void wait(Duration t) { clock->sleep_until(clock->now() + t); }
  // One sweep of so many seconds; empty when the press was refused.
  Sweep record(double seconds_long) {
    board.foot(true);
    wait(from_seconds(seconds_long));
    board.foot(false);
    wait(std::chrono::milliseconds(600));
    return appliance->take_sweep().value_or(Sweep{});
  }

  std::shared_ptr<sim::VirtualClock> clock = std::make_shared<sim::VirtualClock>();
  BoardDevices board;
  std::unique_ptr<cart::Appliance> appliance;
};

bool same_pixels(ConstPixels a, ConstPixels b) {
  for (int y = 0; y < a.height; ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width, b.row(y))) return false;
  return a.width == b.width && a.height == b.height;
}

TEST(CartExams, WhatIsOnTheDiskIsWhatWasInTheRing) {
  const TemporaryFolder folder;
  const std::filesystem::path place = folder.path() / "exams";
  Cart cart(place);
  CartExams& exams = *cart.appliance->exams();
  const std::string id = exams.exam_id();
  EXPECT_TRUE(exams.recovered().empty());
  {
    const ClockMember member(*cart.clock);
    cart.appliance->start();
    cart.wait(std::chrono::milliseconds(1300));  // the tracker takes about a second to start
    exams.new_exam("somebody");
    EXPECT_EQ(cart.appliance->status().saving->state, State::idle);
    EXPECT_TRUE(std::filesystem::is_empty(place) ||
                !std::filesystem::exists(place / (id + ".exam")));  // nothing to save yet
    std::vector<Sweep> sweeps;
    for (int i = 0; i < 2; ++i) sweeps.push_back(cart.record(0.7));
    cart.appliance->stop();
    ASSERT_TRUE(sweeps[0] && sweeps[1]);
    const RecorderStatus saving = *cart.appliance->status().saving;
    EXPECT_EQ(saving.state, State::saved);
    EXPECT_EQ(saving.stored, saving.published);
    EXPECT_EQ(saving.sentence, "");
    EXPECT_EQ(exams.exam_id(), id) << "an exam without a sweep is still the new one";

    const std::filesystem::path file = place / (id + ".exam");
    struct stat s {};
    ASSERT_EQ(::stat(file.c_str(), &s), 0);
    EXPECT_EQ(s.st_mode & 0777, 0600u);
    const ExamReader reader(file);
    EXPECT_EQ(reader.summary().label, "somebody");
    EXPECT_TRUE(reader.summary().closed);
    EXPECT_TRUE(reader.verify().damage.empty());
    const std::vector<SweepSummary> stored = reader.sweeps();
    ASSERT_EQ(stored.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      const Sweep& sweep = sweeps[k];
      SweepLoader loader(file, stored[k].id);
      loader.wait();
      ASSERT_EQ(loader.total(), static_cast<std::int64_t>(sweep.pre_roll().size() + sweep.swept().size()));
      ASSERT_GT(sweep.swept().size(), 15u);
      ASSERT_GT(sweep.pre_roll().size(), 3u);
      std::int64_t i = 0;
      for (const auto& part : {sweep.pre_roll(), sweep.swept()}) {
        for (const SweepFrame& f : part) {
          const FrameRecord& r = loader.stored(i).record;
          const TrackedFrame& t = loader.frame(i);
          EXPECT_TRUE(same_pixels(t.bscan.pixels, f.tracked.bscan.pixels));
          EXPECT_EQ(r.pre_roll, part.data() == sweep.pre_roll().data());
          EXPECT_EQ(t.pose_status, f.tracked.pose_status);
          EXPECT_EQ(t.captured, f.tracked.captured);
          EXPECT_EQ(r.stamped, f.raw.stamped);
          EXPECT_EQ(r.device_count, f.raw.device_sequence);
          if (t.pose_status == PoseStatus::ok) {
            EXPECT_EQ(t.image_from_world.linear, f.tracked.image_from_world.linear);
            EXPECT_EQ(t.image_from_world.translation, f.tracked.image_from_world.translation);
            EXPECT_EQ(r.tracker_from_probe->translation, f.tracker_from_probe.translation);
          }
          ++i;
        }
      }
      EXPECT_TRUE(same_pixels(loader.mask(), cart.appliance->ring().mask()));
      const SweepSetup& setup = loader.setup();
      EXPECT_EQ(setup.pressed, sweep.pressed());
      EXPECT_EQ(setup.latency_offset, std::chrono::milliseconds(60));
      EXPECT_EQ(setup.crop, (CropRect{200, 100, 160, 120}));
      // The ledger, and the raw readings from before the first picture to the release.
      EXPECT_NE(std::find(stored[k].ledger.begin(), stored[k].ledger.end(),
                          Counter{"stored", sweep.swept().size()}),
                stored[k].ledger.end());
      std::vector<std::string> damage;
      const std::vector<PoseSample> poses = reader.poses(stored[k].id, damage);
      EXPECT_NEAR(static_cast<double>(poses.size()), 240 * (0.7 + 0.2 + 0.1), 40);
      ASSERT_FALSE(poses.empty());
      EXPECT_LT(poses.front().time, loader.frame(0).captured);
      EXPECT_GT(poses.back().time, loader.frame(loader.total() - 1).captured);
    }
    const auto list = exams.list();
    ASSERT_TRUE(list);
    ASSERT_EQ(list->size(), 1u);
    EXPECT_EQ(list->front().id, id);
    EXPECT_EQ(list->front().sweeps, 2);
  }
}

TEST(CartExams, ANewExamTakesTheNextSweep) {
  const TemporaryFolder folder;
  Cart cart(folder.path());
  CartExams& exams = *cart.appliance->exams();
  const ClockMember member(*cart.clock);
  cart.appliance->start();
  cart.wait(std::chrono::milliseconds(200));
  const std::string first = exams.exam_id();
  cart.record(0.3);
  exams.new_exam("");
  ASSERT_TRUE(eventually([&] { return exams.exam_id() != first; }));
  const std::string second = exams.exam_id();
  cart.record(0.3);
  cart.record(0.3);
  cart.appliance->stop();
  EXPECT_EQ(ExamReader(folder.path() / (first + ".exam")).sweeps().size(), 1u);
  EXPECT_EQ(ExamReader(folder.path() / (second + ".exam")).sweeps().size(), 2u);
  EXPECT_TRUE(ExamReader(folder.path() / (first + ".exam")).summary().closed);
}

// On a disk of 6 MiB, most of it taken: it is full in the midst of a sweep, which stays in memory until there
// is room.
TEST(CartExams, AFullDiskLosesNothing) {
  test::on_small_disk(6 << 20, [](const std::filesystem::path& place) {
    const std::filesystem::path filler = place / "filler";
    std::ofstream(filler) << std::string(std::size_t{5} << 20, 'x');
    Cart cart(place / "exams", 0);
    const ClockMember member(*cart.clock);
    cart.appliance->start();
    cart.wait(std::chrono::milliseconds(200));
    const auto saving = [&] { return *cart.appliance->status().saving; };
    EXPECT_TRUE(cart.appliance->exams()->has_room());
    cart.record(2.5);  // 75 pictures of 19 KiB
    ASSERT_TRUE(eventually([&] { return saving().state == State::full; }));
    EXPECT_NE(saving().sentence.find("stays in memory"), std::string::npos);
    EXPECT_LT(saving().stored, saving().published);
    std::filesystem::remove(filler);
    EXPECT_TRUE(eventually([&] { return saving().state == State::saved; }));
    EXPECT_EQ(saving().sentence, "");
    EXPECT_EQ(saving().stored, saving().published);
    cart.appliance->stop();
    const ExamReader reader(place / "exams" / (cart.appliance->exams()->exam_id() + ".exam"));
    EXPECT_TRUE(reader.verify().damage.empty());
    EXPECT_EQ(reader.sweeps().at(0).frames, saving().stored);
  });
}

TEST(CartExams, BelowTheReserveAPressIsRefusedAndSaysWhy) {
  const TemporaryFolder folder;
  Cart cart(folder.path(), 1'000'000);
  const ClockMember member(*cart.clock);
  cart.appliance->start();
  cart.wait(std::chrono::milliseconds(200));
  EXPECT_FALSE(cart.record(0.3));
  const cart::ApplianceStatus status = cart.appliance->status();
  EXPECT_EQ(status.cart.note, cart::Note::no_disk);
  EXPECT_EQ(status.cart.acquisition.ledger.presses_refused, 1u);
  EXPECT_FALSE(status.saving->room.may_start);
  EXPECT_NE(status.saving->room.sentence, "");
  cart.appliance->stop();
}

TEST(CartExams, TwoCartsDoNotShareAFolder) {
  const TemporaryFolder folder;
  CartExamsSettings settings;
  settings.place = folder.path();
  settings.recorder.now = [] { return Stamp{}; };
  settings.lock_wait = std::chrono::milliseconds(60);
  const CartExams first(std::move(settings));
  CartExamsSettings again;
  again.place = folder.path();
  again.recorder.now = [] { return Stamp{}; };
  again.lock_wait = {};
  EXPECT_THROW(CartExams(std::move(again)), StoreError);
}

}  // namespace
}  // namespace sonoband::exam
