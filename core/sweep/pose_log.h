// The newest raw readings of the tracker, for whoever keeps them: one writer, any number of readers, fixed
// memory. A reader that is too slow finds its readings overwritten and can tell how many.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/sweep/pose_sample.h"

namespace sonoband {

// Thread rule: one thread adds; read and written are for any. Nobody waits, and after the construction nobody
// allocates.
class PoseLog {
 public:
  // Keeps at least so many: 65536 are 9 MB and four and a half minutes at 240 a second.
  explicit PoseLog(std::size_t capacity);

  void add(const PoseSample& sample);

  std::uint64_t written() const { return written_.load(std::memory_order_acquire); }
  std::size_t capacity() const { return mask_ + 1; }
  // The reading added as the `number`-th, from 0. Empty: overwritten, or not there yet.
  std::optional<PoseSample> read(std::uint64_t number) const;

 private:
  // A sequence lock whose data are atomics as well: a reader that meets a new word also sees that the writer
  // has been here.
  struct Cell {
    std::atomic<std::uint64_t> holds{0};  // number + 1; 0 while it is written
    std::array<std::atomic<std::uint64_t>, 16> words{};
  };

  std::uint64_t mask_;
  std::unique_ptr<Cell[]> cells_;
  std::atomic<std::uint64_t> written_{0};
};

}  // namespace sonoband
