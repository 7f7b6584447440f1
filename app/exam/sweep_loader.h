// A stored sweep on its way back to memory: usable at once, complete a little later.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "app/exam/exam_reader.h"
#include "core/sweep/tracked_frame.h"

namespace sonoband::exam {

// Three quarters of this machine's memory.
std::uint64_t default_memory_limit();

class SweepLoader {
 public:
  // Reads the index of the sweep, then the picture of `first` (a place in the list of frames), then returns;
  // the other pictures follow on a thread of its own. Throws StoreError when the sweep cannot be read at all
  // or its pixels would need more than `memory_limit` bytes.
  SweepLoader(const std::filesystem::path& exam, std::int64_t sweep, std::int64_t first = 0,
              std::uint64_t memory_limit = default_memory_limit());
  ~SweepLoader();  // stops loading
  SweepLoader(const SweepLoader&) = delete;
  SweepLoader& operator=(const SweepLoader&) = delete;

  const SweepSetup& setup() const { return setup_; }
  std::int64_t total() const { return static_cast<std::int64_t>(stored_.size()); }
  std::int64_t visited() const { return visited_.load(std::memory_order_acquire); }  // progress: of total()
  bool done() const { return visited() == total(); }
  void wait();  // until done

  // Of the frame with index i: ready once its pixels are there; never for a damaged one.
  bool ready(std::int64_t i) const { return ready_[i].load(std::memory_order_acquire); }
  const TrackedFrame& frame(std::int64_t i) const { return frames_[i]; }
  const StoredFrame& stored(std::int64_t i) const { return stored_[i]; }

  // The frames that are ready and have a place in space, in order: what a rendering sees now.
  std::vector<const TrackedFrame*> renderable() const;
  MaskView mask() const { return setup_.mask.view(); }

  std::vector<std::string> damage() const;  // so far, one sentence each

 private:
  void load(std::int64_t i);

  ExamReader reader_;
  std::int64_t sweep_;
  SweepSetup setup_;
  std::vector<StoredFrame> stored_;
  std::unique_ptr<std::uint8_t[]> pixels_;  // one slot after the other
  std::vector<TrackedFrame> frames_;
  std::unique_ptr<std::atomic<bool>[]> ready_;
  std::atomic<std::int64_t> visited_{0};
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;  // of damage_
  std::vector<std::string> damage_;
  std::thread thread_;
};

}  // namespace sonoband::exam
