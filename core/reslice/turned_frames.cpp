#include "core/reslice/turned_frames.h"

#include <algorithm>
#include <vector>

#include "core/reslice/frame_table.h"
#include "core/reslice/patch_kernels.h"

namespace sonoband {
namespace {

constexpr int frames_in_turn = 8;  // of each thread, before `stop` is looked at

// The kernel turns squares: columns are written up to the next multiple of their side.
int rounded(int height) {
  constexpr int side = least_turned_px;
  return (height + side - 1) / side * side;
}

std::size_t bytes_of(const Pixels& picture) {
  return static_cast<std::size_t>(picture.width()) * picture.height();
}

}  // namespace

void TurnedFrames::extend(const SweepView& sweep, std::size_t most_bytes, Parallel& parallel,
                          const std::atomic<bool>* stop) {
  std::vector<ConstPixels> missing;
  std::size_t bytes = bytes_;
  for (const TrackedFrame* frame : sweep.frames) {
    const ConstPixels& picture = frame->bscan.pixels;
    if (picture.width < least_turned_px || picture.height < 1 || pictures_.contains(picture.data)) continue;
    missing.push_back(picture);
    bytes += static_cast<std::size_t>(picture.width) * rounded(picture.height);
  }
  if (bytes > most_bytes) return;
  const std::size_t in_turn = static_cast<std::size_t>(frames_in_turn) * parallel.width();
  for (std::size_t first = 0; first < missing.size(); first += in_turn) {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) return;
    const std::size_t count = std::min(in_turn, missing.size() - first);
    std::vector<Pixels> turned(count);
    parallel.for_each(static_cast<int>(count), [&](int i) {
      const ConstPixels& from = missing[first + i];
      turned[i] = Pixels::unset(rounded(from.height), from.width);
      patch_kernels().turn({from.data, from.stride, from.width, from.height}, 0, 0, from.width, from.height,
                           turned[i].view().data, turned[i].width());
    });
    for (std::size_t i = 0; i < count; ++i) {
      bytes_ += bytes_of(turned[i]);
      pictures_.emplace(missing[first + i].data, std::move(turned[i]));
    }
  }
}

void TurnedFrames::clear() {
  pictures_.clear();
  bytes_ = 0;
}

void TurnedFrames::enter(FrameTable& table) const {
  for (FrameEntry& frame : table.frames) {
    const auto found = pictures_.find(frame.pixels);
    if (found == pictures_.end()) continue;
    frame.turned = found->second.view().data;
    frame.turned_stride = found->second.width();
  }
}

}  // namespace sonoband
