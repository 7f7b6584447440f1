// One exam file, open for adding. Every call returns only when what it added would survive a power cut, and
// throws StoreError when it did not; then nothing of that call is there. One thread at a time.
//
// Why these settings: WAL, so that review reads while a sweep is written, and an interrupted commit is simply
// not there; synchronous=FULL, because in WAL with NORMAL a commit is not synced and a power cut would take
// back what the screen has called saved; pages of 16 KiB, because a picture is some hundred KiB.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/exam/frame_codec.h"
#include "app/exam/records.h"
#include "app/exam/sqlite.h"

namespace sonoband::exam {

class ExamWriter {
 public:
  // A new exam. It is made under another name and renamed when whole, so that half an exam never shows.
  static ExamWriter create(const std::filesystem::path& file, const std::string& id,
                           const std::string& vfs = {});
  // An exam that is there. Migrates an older schema.
  static ExamWriter open(const std::filesystem::path& file, const std::string& vfs = {});

  std::int64_t next_sweep() const;
  // Nothing happens if the sweep is there already: a call whose answer was lost may be made again.
  void begin_sweep(std::int64_t sweep, const SweepSetup& setup);
  std::int64_t stored_frames(std::int64_t sweep) const;
  std::int64_t stored_poses(std::int64_t sweep) const;
  // All or nothing. Frames are numbered on from stored_frames (asserted).
  void append(std::int64_t sweep, std::span<const FrameRecord> frames, std::span<const PoseSample> poses);
  // The sweep has `frames` frames; what is stored beyond them was taken after the release, before that was
  // known, and stays in the file unseen.
  void end_sweep(std::int64_t sweep, std::int64_t frames, const std::vector<Counter>& ledger,
                 bool interrupted = false);
  std::vector<std::int64_t> sweeps_without_end() const;

  // A new object, or the next version of one; gives the version. Rows are never changed.
  std::int64_t add_review(const ReviewObject& object);
  void set_label(const std::string& label);
  void add_event(const std::string& what, const std::string& detail);

  // Makes the file whole by itself (no journal beside it) if no reader is in the way; says so in an event.
  void close();
  // What the journal holds goes into the file; see Database::checkpoint.
  bool checkpoint(bool empty_journal) { return database_.checkpoint(empty_journal); }

 private:
  ExamWriter(const std::filesystem::path& file, Database::Mode mode, const std::string& vfs);
  void prepare();

  Database database_;
  Statement add_frame_;
  Statement add_pixels_;
  Statement add_pose_;
  PackedPixels packed_;
  std::vector<std::uint8_t> scratch_;
};

std::int64_t utc_now_ns();

}  // namespace sonoband::exam
