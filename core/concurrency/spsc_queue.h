// A fixed queue between exactly two threads that never waits and never allocates after it is made.
//
// Thread rule: one thread calls try_emplace (the producer), one other calls front and pop (the consumer); any
// other use is a race. Construct and destroy while neither runs.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace sonoband {

template <class T>
class SpscQueue {
 public:
  // Holds `capacity` elements; one slot more is kept free to tell full from empty.
  explicit SpscQueue(std::size_t capacity) : size_(capacity + 1), slots_(new Slot[size_]) {}
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;
  ~SpscQueue() {
    while (front() != nullptr) pop();
  }

  // Producer. False when full: the element is refused, nothing is overwritten. Count it.
  template <class... Args>
  [[nodiscard]] bool try_emplace(Args&&... args) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = after(tail);
    if (next == seen_head_) {
      seen_head_ = head_.load(std::memory_order_acquire);
      if (next == seen_head_) return false;
    }
    ::new (static_cast<void*>(slots_[tail].bytes)) T(std::forward<Args>(args)...);
    tail_.store(next, std::memory_order_release);
    return true;
  }

  // Consumer. The oldest element, in place, until pop; null when there is none.
  T* front() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == seen_tail_) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head == seen_tail_) return nullptr;
    }
    return std::launder(reinterpret_cast<T*>(slots_[head].bytes));
  }

  // Consumer. Precondition: front() is not null.
  void pop() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    std::launder(reinterpret_cast<T*>(slots_[head].bytes))->~T();
    head_.store(after(head), std::memory_order_release);
  }

 private:
  struct Slot {
    alignas(T) std::byte bytes[sizeof(T)];
  };

  std::size_t after(std::size_t i) const { return i + 1 == size_ ? 0 : i + 1; }

  const std::size_t size_;
  const std::unique_ptr<Slot[]> slots_;
  // Each side's index and its copy of the other's share a cache line that the other side does not write, so
  // the line travels between the cores only when the copy runs out. 64 bytes: x86-64 and the Cortex-A cores.
  alignas(64) std::atomic<std::size_t> tail_{0};
  std::size_t seen_head_ = 0;
  alignas(64) std::atomic<std::size_t> head_{0};
  std::size_t seen_tail_ = 0;
};

}  // namespace sonoband
