// A mailbox for one value between exactly two threads: the newest wins, what it replaced is counted, and
// neither side ever waits.
//
// Thread rule: one thread calls put, one other calls take; replaced may be called by any. Three cells: one is
// the writer's, one the reader's, one lies between them and changes hands by a single exchange.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <utility>

namespace sonoband {

template <class T>
class Latest {
 public:
  // Writer.
  void put(T value) {
    cells_[writing_] = std::move(value);
    const std::uint8_t was =
        between_.exchange(static_cast<std::uint8_t>(writing_ | fresh), std::memory_order_acq_rel);
    writing_ = was & index;
    if ((was & fresh) != 0) replaced_.fetch_add(1, std::memory_order_relaxed);
  }

  // Reader. The newest value not yet taken, valid until the next take; null when there is none.
  T* take() {
    if ((between_.load(std::memory_order_relaxed) & fresh) == 0) return nullptr;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & index;
    return &cells_[reading_];
  }

  // Values that were put and never taken because a newer one came.
  std::uint64_t replaced() const { return replaced_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint8_t index = 3;
  static constexpr std::uint8_t fresh = 4;

  std::array<T, 3> cells_{};
  std::uint8_t writing_ = 0;
  std::uint8_t reading_ = 1;
  std::atomic<std::uint8_t> between_{2};
  std::atomic<std::uint64_t> replaced_{0};
};

}  // namespace sonoband
