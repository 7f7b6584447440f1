#include "tests/app/exam/crash_support.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "app/exam/exam_reader.h"
#include "app/exam/exam_writer.h"

namespace sonoband::exam::test {

namespace fs = std::filesystem;

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

ReviewObject note(std::int64_t number) {
  return {.object = "note" + std::to_string(number),
          .kind = ReviewKind::note,
          .json = "{\"number\":" + std::to_string(number) + "}",
          .png = {}};
}

// One sweep in six batches with review between them; goes on from what is in the file, as the recorder does.
void record_script(const fs::path& file, const std::string& vfs, const MadeSweep& sweep, Acknowledged& done) {
  ExamWriter writer = ExamWriter::open(file, vfs);
  writer.begin_sweep(1, small_setup(script_width, script_height));
  done.sweep = true;
  done.frames = writer.stored_frames(1);
  while (done.frames < script_frames) {
    std::vector<FrameRecord> batch;
    std::vector<PoseSample> poses;
    for (std::int64_t i = done.frames; i < std::min(done.frames + 3, script_frames); ++i) {
      batch.push_back(sweep.frame(i));
      for (std::int64_t p = 4 * i; p < 4 * i + 4; ++p) poses.push_back(reading(p, 1));
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

::pid_t start_child(const std::function<void()>& body) {
  std::fflush(nullptr);
  const ::pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child could be started");
  if (child > 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  body();
  ::_exit(1);
}

std::int64_t kill_child(::pid_t child) {
  ::kill(child, SIGKILL);
  const std::int64_t killed = std::chrono::steady_clock::now().time_since_epoch().count();
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << status;
  return killed;
}

SmallCart::SmallCart(const fs::path& place, int ring_frames) {
  Profile profile;
  profile.capture.rate_hz = 60;
  profile.capture.crop_px = {200, 100, 160, 120};
  profile.ring.frames = ring_frames;
  profile.ring.pre_roll_s = 0.2;
  profile.exams.reserve_mb = 0;
  const auto clock = std::make_shared<SystemClock>();
  board = make_sim_board(profile, *clock);
  cart = make_appliance(board, profile, clock, place);
  cart->start();
}

}  // namespace sonoband::exam::test
