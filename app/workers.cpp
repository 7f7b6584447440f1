#include "app/workers.h"

#include <algorithm>

namespace sonoband {

Workers::Workers(int threads) {
  for (int i = 1; i < std::max(threads, 1); ++i) threads_.emplace_back([this] { serve(); });
}

Workers::~Workers() {
  ending_.store(true, std::memory_order_relaxed);
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
  inside_.store(open, std::memory_order_release);
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  take_part(body, count);
  // Nothing is left to begin: a thread that wakes only now stays out, and is not waited for.
  for (std::uint32_t inside = inside_.fetch_and(~open, std::memory_order_acq_rel) & ~open; inside != 0;
       inside = inside_.load(std::memory_order_acquire)) {
    inside_.wait(inside, std::memory_order_acquire);
  }
}

// True where a job is on; it ends only when leave() has been called.
bool Workers::enter() {
  std::uint32_t inside = inside_.load(std::memory_order_acquire);
  while ((inside & open) != 0) {
    if (inside_.compare_exchange_weak(inside, inside + 1, std::memory_order_acq_rel)) return true;
  }
  return false;
}

void Workers::leave() {
  if (inside_.fetch_sub(1, std::memory_order_acq_rel) == 1) inside_.notify_one();
}

void Workers::serve() {
  for (std::uint32_t seen = 0;;) {
    generation_.wait(seen, std::memory_order_acquire);
    seen = generation_.load(std::memory_order_acquire);
    if (ending_.load(std::memory_order_relaxed)) return;
    if (!enter()) continue;
    take_part(*body_, count_);
    leave();
  }
}

void Workers::take_part(const std::function<void(int)>& body, int count) {
  for (int i = next_.fetch_add(1, std::memory_order_relaxed); i < count;
       i = next_.fetch_add(1, std::memory_order_relaxed)) {
    body(i);
  }
}

}  // namespace sonoband
