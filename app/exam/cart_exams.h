// The exams of a running cart: takes every sweep to disk while it grows. Acquisition never waits for it, and
// it does not wait for the screen.
//
//     capture thread ──on_reading, begin, ended (no heap, no lock)──▶ keeper thread ──▶ Recorder's thread ──▶
//     disk owner ──status, list, new_exam, add_review──▶
#pragma once

#include <semaphore.h>

#include <atomic>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "app/exam/exam_folder.h"
#include "app/exam/recorder.h"
#include "core/concurrency/spsc_queue.h"
#include "core/sweep/pose_log.h"
#include "core/sweep/sweep.h"

namespace sonoband::exam {

struct CartExamsSettings {
  std::filesystem::path place;
  // Of every sweep; `pressed` and its date are filled in.
  SweepSetup sweep;
  RecorderSettings recorder;  // without new_id; `now` is the cart's clock
  // How long to wait for a former cart program that is still ending.
  Duration lock_wait = std::chrono::seconds(10);
};

// A sweep as it is stored.
struct StoredSweep {
  std::string exam;        // id
  std::int64_t sweep = 0;  // 1, 2, 3 ... within the exam
  bool operator==(const StoredSweep&) const = default;
};

// One exam holds the sweeps of a run until the next new_exam; its file is made with its first sweep.
class CartExams {
 public:
  // Recovers what a former run left. Throws StoreError where the folder cannot be used.
  explicit CartExams(CartExamsSettings settings);
  ~CartExams();  // finishes
  CartExams(const CartExams&) = delete;
  CartExams& operator=(const CartExams&) = delete;

  // Capture thread.
  void on_reading(const PoseSample& reading) { readings_.add(reading); }
  void begin(const Sweep& sweep);  // at most 16 that the keeper has not seen yet: more than a ring holds
  void ended();                    // a sweep has got its last frame
  bool has_room() const { return has_room_.load(std::memory_order_relaxed); }

  // Any thread; these never wait for the disk.
  // Of the present exam; of an earlier one while that is in trouble.
  RecorderStatus status() const;
  std::string exam_id() const;  // of the present exam, made or not
  const std::filesystem::path& place() const { return folder_.place(); }
  // What this start found cut off or damaged: a sentence each.
  const std::vector<std::string>& recovered() const { return folder_.recovered(); }
  // Newest first, read anew after each saved sweep and when asked. Null: not read yet.
  std::shared_ptr<const std::vector<ExamSummary>> list() const;
  void ask_for_list();
  // The next sweep begins another exam, of a patient with this label (may be empty). An exam that has no
  // sweep yet only gets the label.
  void new_exam(std::string label);
  // Where the sweep of this run with this id (Sweep::id) goes. Empty for the moments until the keeper has it.
  std::optional<StoredSweep> where(std::int32_t sweep) const;
  // To the exam with this id: the present one, or any that is there.
  void add_review(const std::string& exam, ReviewObject object);
  // Whether all that add_review was given for this exam would survive a power cut.
  bool review_saved(const std::string& exam) const;

  // Deletes the exam with this id; put_back undoes the last one. Its file goes with the next remove, with the
  // end of the run, or when recording needs the room. One that is still being saved is not deleted.
  void remove(std::string exam);
  void put_back();
  struct Removal {
    std::string exam;        // that put_back would bring back; empty: none
    std::string sentence;    // why the last wish could not be carried out; empty: it was, or is still waiting
    std::uint64_t done = 0;  // wishes answered
  };
  Removal removal() const;

  // After the last begin: saves what can be saved and lets go of every sweep; waits for the disk, at most
  // RecorderSettings::goodbye when that is in trouble.
  void finish();

 private:
  void keep();
  void take_sweeps();
  void take_wishes();
  void take_reviews();
  void take_removals();
  std::string remove_now(const std::string& exam);
  void begin_exam();
  void let_go_of_saved();
  void read_list();
  std::unique_ptr<Recorder> make_recorder();

  CartExamsSettings settings_;
  ExamFolder folder_;
  PoseLog readings_{65536};
  SpscQueue<Sweep> begun_{16};
  ::sem_t wake_;  // posting it takes no lock, so the capture thread may
  std::atomic<bool> ending_{false};
  std::atomic<bool> save_now_{false};
  std::atomic<bool> has_room_{false};

  mutable std::mutex mutex_;  // held for moments, never while the disk works
  std::unique_ptr<Recorder> recorder_;
  std::map<std::string, std::unique_ptr<Recorder>> former_;  // by id: still saving, or reviewed just now
  std::string reviewed_;                                     // the last of them that got a review
  std::string id_;
  bool used_ = false;  // the present exam has a sweep or a review
  std::int64_t begun_in_exam_ = 0;
  std::map<std::int32_t, StoredSweep> where_;
  std::deque<std::pair<std::string, ReviewObject>> reviews_;  // of other exams than the present
  std::size_t reviews_under_way_ = 0;                         // of those, not with a recorder yet
  std::map<std::string, std::uint64_t> tickets_;              // the last one's, by exam
  std::optional<std::string> new_exam_;
  std::deque<std::string> removals_;  // empty: put back
  Removal removal_;
  std::set<std::string> deleted_;  // of this run; reviews of them are dropped
  bool list_wanted_ = true;
  std::shared_ptr<const std::vector<ExamSummary>> list_;

  std::thread thread_;
};

}  // namespace sonoband::exam
