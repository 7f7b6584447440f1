// One exam file, open for reading; a recording of it may go on meanwhile. Damage is found by checksums,
// named, and contained: what is whole still comes. One thread at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/exam/frame_codec.h"
#include "app/exam/records.h"
#include "app/exam/sqlite.h"

namespace sonoband::exam {

// A frame without its pixels. record.pixels has the size, and no data.
struct StoredFrame {
  FrameRecord record;
  Codec codec = Codec::raw;
  std::int64_t pixels_checked = 0;
};

// What could be read, and one sentence for each place that could not.
struct StoredFrames {
  std::vector<StoredFrame> frames;  // in order of number; damaged ones are left out
  std::vector<std::string> damage;
};

class ExamReader {
 public:
  // Throws StoreError when it is no exam, or one that cannot be opened at all.
  explicit ExamReader(const std::filesystem::path& file, const std::string& vfs = {});

  ExamSummary summary() const;
  std::vector<SweepSummary> sweeps() const;  // throws StoreError where the tables are damaged
  SweepSetup setup(std::int64_t sweep) const;
  // The index of a sweep: small rows only, no pixels.
  StoredFrames frames(std::int64_t sweep) const;
  // Empty: `out` (of the frame's size) holds the picture. Otherwise what is wrong with it, and `out` is to be
  // thrown away.
  std::string pixels(std::int64_t sweep, const StoredFrame& frame, ImageView<std::uint8_t> out) const;
  std::vector<PoseSample> poses(std::int64_t sweep, std::vector<std::string>& damage) const;
  // The versions in force, without what was removed; `all` gives every version of everything.
  std::vector<ReviewObject> review(std::vector<std::string>& damage, bool all = false) const;

  // Reads every row and every page. `progress` gets parts per thousand and stops it by giving false.
  struct Verification {
    std::int64_t sweeps = 0;
    std::int64_t frames = 0;
    std::int64_t poses = 0;
    std::int64_t reviews = 0;
    std::vector<std::string> damage;  // one sentence each; empty: every byte of ours is as it was written
  };
  Verification verify(const std::function<bool(int)>& progress = {}) const;

 private:
  std::int64_t count_frames(std::int64_t sweep) const;

  std::filesystem::path file_;
  Database database_;
  mutable Statement pixels_;  // made on first use
  mutable bool prepared_ = false;
};

}  // namespace sonoband::exam
