// Proof that a path takes no heap: counts what this thread's operator new does while the counter lives.
#pragma once

#include <cstdint>

namespace sonoband::test {

// Counts every form of operator new on the thread that made it; other threads are not seen, so test runners
// and workers do not disturb. Counters may nest. malloc called directly (C libraries) is not counted.
class AllocationCounter {
 public:
  AllocationCounter();
  ~AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;

  std::uint64_t count() const;  // since construction; read it on the same thread

 private:
  std::uint64_t before_;
};

}  // namespace sonoband::test
