// The thread that takes sweeps from the ring to the disk. Acquisition never waits for it: it reads what is
// published, and what is slow or failing stays in the ring meanwhile.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/exam/exam_folder.h"
#include "app/exam/exam_writer.h"
#include "app/exam/records.h"

namespace sonoband::exam {

// What the recorder reads: a sweep that may still grow. Called only on the recorder's thread; must not block.
class SweepSource {
 public:
  virtual ~SweepSource() = default;
  // True when `published` and `ledger` are final. Asked before `published`.
  virtual bool finished() const = 0;
  // Frames 0 .. published() - 1 stay as they are while this object lives. At the finish it may fall: frames
  // after the release, handed out before that was known, do not count.
  virtual std::int64_t published() const = 0;
  virtual FrameRecord frame(std::int64_t number) const = 0;
  // Moves raw readings out, oldest first; gives how many.
  virtual std::size_t take_poses(std::span<PoseSample> out) = 0;
  // Once finished: where every frame went.
  virtual std::vector<Counter> ledger() const = 0;
};

struct RecorderSettings {
  Duration batch = std::chrono::milliseconds(250);  // what a power cut may cost
  Duration retry = std::chrono::seconds(2);         // between attempts on a disk in trouble
  Duration goodbye = std::chrono::seconds(10);      // the destructor waits so long for a disk in trouble
  std::int64_t reserve_bytes = std::int64_t{512} << 20;
  // The journal is copied into the exam beyond this: bounds it on disk, and what a start must read.
  std::int64_t journal_bytes = std::int64_t{64} << 20;
  double bytes_per_second = 640 * 480 * 30.0;  // for the room left, until the first sweep tells
  // Not empty: the exam is not there yet, and is made under this id with the first thing to save.
  std::string new_id;
  std::function<Stamp()> now;  // of the clock that stamps frames; empty: CLOCK_MONOTONIC
  std::string vfs;
};

struct RecorderStatus {
  enum class State : std::uint8_t {
    idle,       // nothing to do
    recording,  // a sweep grows and is being saved
    saving,     // it has ended, its rest is on the way
    saved,      // everything handed over would survive a power cut
    full,       // no room: frames stay in memory, see sentence
    failing,    // the disk does not do what it should: frames stay in memory, see sentence
  };
  State state = State::idle;
  std::int64_t sweep = 0;      // the id of the newest sweep; 0 before the first
  std::int64_t published = 0;  // frames of all sweeps handed over
  std::int64_t stored = 0;     // of those, durable
  Duration oldest_unsaved{};   // how long the oldest frame not durable has waited; over two batches: slow
  std::uint64_t reviews_saved = 0;  // tickets up to this one are durable
  std::uint64_t poses_dropped = 0;  // raw readings that found no room while the disk was in trouble
  std::string sentence;             // for the operator; empty while all is well
  Room room;
};

class Recorder {
 public:
  // Saves into an exam that is there (ExamWriter::create), or see `new_id`. Starts its thread; opens the file
  // on it.
  Recorder(const std::filesystem::path& exam, const RecorderSettings& settings);
  ~Recorder();  // finishes
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Whether the disk has room for a sweep that would start now, as measured within the last second. Any
  // thread; takes no lock. A press below the reserve is to be refused.
  bool has_room() const { return has_room_.load(std::memory_order_relaxed); }
  // At the press. From here on the sweep is saved, into the reserve if need be. Never waits for the disk.
  void begin(std::shared_ptr<SweepSource> source, SweepSetup setup);
  // At the release, or whenever the batch should not be waited for.
  void save_now();

  // Gives a ticket; see RecorderStatus::reviews_saved.
  std::uint64_t add_review(ReviewObject object);
  // Of the patient. Saved with the next sweep or review; a label alone makes no exam.
  void set_label(std::string label);

  // Saves what can be saved, at most `goodbye` long when the disk is in trouble, closes the exam and lets go
  // of all sources. The status stays. Once.
  void finish();

  RecorderStatus status() const;  // any thread, never waits for the disk

 private:
  struct Job {
    std::shared_ptr<SweepSource> source;
    SweepSetup setup;
    std::int64_t sweep = 0;  // 0: not known yet
    bool begun = false;
    std::int64_t stored = 0;
    std::int64_t poses_stored = 0;
    std::vector<PoseSample> poses;  // taken, not yet durable
    std::uint64_t poses_dropped = 0;
  };

  void run();
  void work();             // one round over all that waits; throws StoreError
  bool work_on(Job& job);  // true: this sweep is done
  void connect();
  void measure_room();
  Stamp now() const;
  void trouble(const StoreError& error);
  void tell();

  const std::filesystem::path exam_;
  const RecorderSettings settings_;

  mutable std::mutex mutex_;  // held for moments only, never while the disk works
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Job>> new_jobs_;
  std::deque<ReviewObject> new_reviews_;
  std::optional<std::string> new_label_;
  std::uint64_t tickets_ = 0;
  bool now_ = false;
  bool ending_ = false;
  RecorderStatus status_;

  std::atomic<bool> has_room_{false};

  // The recorder's thread only.
  std::optional<ExamWriter> writer_;
  std::deque<std::shared_ptr<Job>> jobs_;
  std::deque<ReviewObject> reviews_;
  std::optional<std::string> label_;
  bool made_ = false;  // never made twice: where the exam was there may now be another disk
  std::vector<FrameRecord> batch_;
  std::int64_t published_before_ = 0;  // by sweeps that are done
  std::int64_t next_sweep_ = 0;        // 0: ask the file
  std::int64_t in_journal_ = 0;        // bytes since the last checkpoint, about
  Stamp room_measured_{};
  double bytes_per_second_ = 0;

  std::thread thread_;
};

}  // namespace sonoband::exam
