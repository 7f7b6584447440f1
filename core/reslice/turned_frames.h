// A sweep's pictures kept a second time, turned: where the lines of a plane run along pixel columns these lie
// along memory, and no tile has to turn its part of them. The bits are the same.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "core/image/image.h"
#include "core/parallel.h"
#include "core/reslice/band.h"

namespace sonoband {

struct FrameTable;

// Pictures are known by where their pixels are, which must stay as they are until clear(). Not for two
// threads at once; renderings only read it.
class TurnedFrames {
 public:
  // Turns those of the sweep that are not turned yet, 0.1 ms of 640x480 each, several at a time; none where
  // all of them would take more than `most_bytes`. Ends soon after `stop` is set and may be called again.
  void extend(const SweepView& sweep, std::size_t most_bytes, Parallel& parallel,
              const std::atomic<bool>* stop = nullptr);
  void clear();
  std::size_t bytes() const { return bytes_; }

  // Where the table's frames have a turned picture they get to know it.
  void enter(FrameTable& table) const;

 private:
  std::unordered_map<const std::uint8_t*, Pixels> pictures_;  // by the pixels they are of
  std::size_t bytes_ = 0;
};

}  // namespace sonoband
