#include "app/workers.h"

#include <algorithm>

namespace sonoband {

Workers::Workers(int threads) {
  for (int i = 1; i < std::max(threads, 1); ++i) threads_.emplace_back([this] { serve(); });
}

Workers::~Workers() {
  ending_ = true;
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  for (std::thread& t : threads_) t.join();
}

void Workers::for_each(int count, const std::function<void(int)>& body) {
  // Waking a thread costs some 50 us; a job of one has no use for it.
  if (threads_.empty() || count <= 1) {
    for (int i = 0; i < count; ++i) body(i);
    return;
  }
  body_ = &body;
  count_ = count;
  next_.store(0, std::memory_order_relaxed);
  busy_.store(static_cast<int>(threads_.size()), std::memory_order_relaxed);
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  take_part(body, count);
  for (int busy = busy_.load(std::memory_order_acquire); busy != 0;
       busy = busy_.load(std::memory_order_acquire)) {
    busy_.wait(busy, std::memory_order_acquire);
  }
}

void Workers::serve() {
  for (std::uint32_t seen = 0;;) {
    generation_.wait(seen, std::memory_order_acquire);
    seen = generation_.load(std::memory_order_acquire);
    if (ending_) return;
    take_part(*body_, count_);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

void Workers::take_part(const std::function<void(int)>& body, int count) {
  for (int i = next_.fetch_add(1, std::memory_order_relaxed); i < count;
       i = next_.fetch_add(1, std::memory_order_relaxed)) {
    body(i);
  }
}

}  // namespace sonoband
