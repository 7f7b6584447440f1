// A whole cart with its desk for review, killed at random moments of recording and reviewing: what the desk
// was told to be on the disk is there, to the last bit, in the exam of this run and in an earlier one.
// SONOBAND_CRASH_MOMENTS says how often; tools/crash-tests makes the README's row of it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <random>
#include <thread>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_reader.h"
#include "app/exam/exam_writer.h"
#include "app/screen/exam_desk.h"
#include "tests/app/exam/crash_support.h"

namespace sonoband::test {
namespace {

namespace fs = std::filesystem;
namespace c = ui::command;

constexpr const char* earlier_id = "20260101-000000-0000";
constexpr std::uint64_t first_opened_id = std::uint64_t{1} << 31;  // sweeps out of earlier exams

// Landmarks that were on the disk by what the exams said, and all that were set.
struct Diary {
  std::atomic<std::int64_t> present{0};
  std::atomic<std::int64_t> earlier{0};
  std::atomic<std::int64_t> set{0};
  std::atomic<std::int64_t> frames{0};
};

void make_earlier(const fs::path& place) {
  fs::create_directories(place);
  exam::ExamWriter writer = exam::ExamWriter::create(place / (std::string(earlier_id) + ".exam"), earlier_id);
  writer.set_label("earlier");
  exam::SweepSetup setup = exam::test::small_setup(64, 48);
  writer.begin_sweep(1, setup);
  Pixels picture(64, 48);
  for (int i = 0; i < 20; ++i) {
    exam::test::paint(i, 1, picture.view());
    exam::FrameRecord f = exam::test::record(i, 1, picture.view());
    f.pre_roll = false;
    f.pose_status = PoseStatus::ok;
    f.world_from_image.linear = Eigen::Matrix3d::Identity() * 0.2;
    f.world_from_image.translation = {0, 0, 0.5 * i};
    writer.append(1, {{f}}, {});
  }
  writer.end_sweep(1, 20, {});
  writer.close();
}

// What the screen's loop does, without a screen: follows sweeps, carries out commands, lets the desk save.
class Reviewer {
 public:
  Reviewer(cart::Appliance& cart, Diary& diary)
      : cart_(cart), diary_(diary), desk_(*cart.exams(), session_, {}, {}) {}

  void follow() {
    while (auto sweep = cart_.take_sweep()) {
      growing_ = std::make_shared<Sweep>(std::move(*sweep));
      session_.begin_sweep(static_cast<std::uint64_t>(growing_->id()));
    }
    if (!growing_ || !growing_->released()) return;
    RunSweep s;
    s.held = {growing_->view(), growing_};
    s.id = static_cast<std::uint64_t>(growing_->id());
    session_.grow_sweep(s, true);
    growing_.reset();
    while (session_.sweep_count() > 2 && session_.let_go_oldest()) {
    }
  }
  void open_earlier() {
    ui::ExamsView rows;
    desk_.fill(rows, false);
    for (const ui::ExamView& row : rows.exams)
      if (row.label == "earlier") desk_.carry_out(c::OpenExam{row.id});
  }
  // A landmark at (n, 2n, 3n), a stroke and a contour; the plane moves.
  void make_something(std::int64_t i) {
    if (session_.shown_id() == 0) return;
    const bool earlier = session_.shown_id() >= first_opened_id;
    if (!earlier && !cart_.exams()->where(static_cast<std::int32_t>(session_.shown_id()))) return;
    const auto n = static_cast<double>(++placed_[session_.shown_id()]);
    session_.apply(c::PlaceLandmark{{n, 2 * n, 3 * n}});
    if (i % 3 == 0) session_.apply(c::PushPlane{0.1});
    if (i % 5 == 0) {
      session_.apply(c::BeginStroke{{1, 1}});
      session_.apply(c::ExtendStroke{{5 + n / 100, 3}});
      session_.apply(c::EndStroke{});
    }
    if (i % 4 == 0) {
      session_.apply(c::BeginContour{{0, 0, 0}, ui::Window::reslice});
      session_.apply(c::ExtendContour{{3, 0, 0}});
      session_.apply(c::ExtendContour{{3, n, 0}});
      session_.apply(c::EndContour{});
    }
    ++diary_.set;
    ++(earlier ? earlier_ : present_);
  }
  void save() {
    for (int twice = 0; twice < 2; ++twice) {  // at rest the second time
      session_.tick(now_);
      desk_.listen(now_);
      now_ += std::chrono::milliseconds(250);
    }
    const exam::CartExams& exams = *cart_.exams();
    if (exams.review_saved(exams.exam_id())) diary_.present = present_;
    if (exams.review_saved(earlier_id)) diary_.earlier = earlier_;
    diary_.frames = exams.status().stored;
  }

 private:
  cart::Appliance& cart_;
  Diary& diary_;
  RenderWorker worker_{1};
  Session session_{worker_, ui::PedalMode::hold};
  ExamDesk desk_;
  std::shared_ptr<Sweep> growing_;
  std::map<std::uint64_t, std::int64_t> placed_;  // by sweep
  std::int64_t present_ = 0;
  std::int64_t earlier_ = 0;
  Stamp now_{std::chrono::seconds(1)};
};

[[noreturn]] void review_until_killed(const fs::path& place, Diary& diary) {
  exam::test::SmallCart small(place, 400);
  Reviewer reviewer(*small.cart, diary);
  for (std::int64_t i = 0;; ++i) {
    const std::int64_t moment = i % 100;
    if (moment == 10) static_cast<void>(small.board.foot(true));
    if (moment == 40) static_cast<void>(small.board.foot(false));
    if (moment == 70) reviewer.open_earlier();
    static_cast<void>(small.cart->status());
    reviewer.follow();
    // Not while a sweep grows: the screen is on its Live page then.
    if (moment < 10 || moment > 45) reviewer.make_something(i);
    reviewer.save();
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
  }
}

// The landmarks of the exam; every object of it is whole and says what was made.
std::int64_t landmarks_in(const fs::path& file) {
  const exam::ExamReader reader(file);
  EXPECT_EQ(reader.verify().damage, std::vector<std::string>{});
  std::vector<std::string> damage;
  const std::vector<exam::ReviewObject> objects = reader.review(damage);
  EXPECT_EQ(damage, std::vector<std::string>{});
  std::int64_t count = 0;
  for (const exam::SweepSummary& s : reader.sweeps()) {
    EXPECT_TRUE(s.ended);
    std::vector<std::string> refused;
    const SweepReview review = review_of(objects, s.id, refused);
    EXPECT_EQ(refused, std::vector<std::string>{});
    for (const ui::LandmarkView& l : review.landmarks)
      EXPECT_EQ(l.at_world, Eigen::Vector3d(l.number, 2.0 * l.number, 3.0 * l.number));
    count += static_cast<std::int64_t>(review.landmarks.size());
  }
  return count;
}

TEST(Crash, CartKilledAtRandomMomentsOfRecordingAndReviewing) {
  const exam::test::TemporaryFolder folder;
  const int count = exam::test::moments(3);
  std::mt19937_64 random(13);
  exam::test::SharedDiary<Diary> shared;
  make_earlier(folder.path() / "made");
  std::int64_t acknowledged = 0;
  std::int64_t set = 0;
  std::int64_t lost = 0;
  int while_reviewing = 0;
  for (int i = 0; i < count; ++i) {
    Diary& diary = shared.blank();
    const fs::path place = folder.path() / std::to_string(i);
    fs::copy(folder.path() / "made", place);
    const ::pid_t child = exam::test::start_child([&] { review_until_killed(place, diary); });
    EXPECT_TRUE(exam::test::eventually([&] { return diary.frames > 0; }));
    ::usleep(static_cast<::useconds_t>(random() % 1'600'000));
    exam::test::kill_child(child);
    const exam::ExamFolder exams(place, exam::ExamFolder::Use::cart);  // the next start
    // Its sweep had its end before; a torn batch of review is all that can be cut off of it.
    for (const std::string& sentence : exams.recovered())
      if (sentence.starts_with(earlier_id)) {
        EXPECT_EQ(sentence.find("had no end"), std::string::npos) << sentence;
      }
    std::int64_t present = 0;
    std::int64_t earlier = 0;
    std::int64_t frames = 0;
    for (const exam::ExamSummary& e : exams.list()) {
      (e.id == earlier_id ? earlier : present) += landmarks_in(e.path);
      if (e.id != earlier_id) frames += e.frames;
    }
    EXPECT_GE(present, diary.present);
    EXPECT_GE(earlier, diary.earlier);
    EXPECT_GE(frames, diary.frames);
    lost += present < diary.present || earlier < diary.earlier || frames < diary.frames;
    acknowledged += diary.present + diary.earlier;
    set += diary.set;
    while_reviewing += diary.set > 0;
    if (testing::Test::HasFailure()) return;
    std::error_code none;
    fs::remove_all(place, none);
  }
  if (count > 20) {
    EXPECT_GT(acknowledged, 0);
  }
  exam::test::table_row("kill -9 of a cart that records, reviews and reviews an earlier exam", count,
                        (lost == 0 ? "nothing acknowledged lost: " : "LOST some: ") +
                            std::to_string(acknowledged) + " acknowledged of " + std::to_string(set) +
                            " landmarks set; " + std::to_string(while_reviewing) +
                            " times in the midst of reviewing");
}

}  // namespace
}  // namespace sonoband::test
