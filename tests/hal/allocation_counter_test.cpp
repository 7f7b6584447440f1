// The counter that other tests lean on sees what it should, and nothing else.
#include "tests/support/allocation_counter.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace sonoband::test {
namespace {

TEST(AllocationCounter, SeesEveryFormOfNewOnItsThread) {
  struct alignas(128) Wide {
    char bytes[128];
  };
  std::vector<int> grown;
  const AllocationCounter counter;
  EXPECT_EQ(counter.count(), 0u);
  grown.reserve(1000);
  EXPECT_EQ(counter.count(), 1u);
  const auto wide = std::make_unique<Wide>();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(wide.get()) % 128, 0u);
  EXPECT_EQ(counter.count(), 2u);
  ::operator delete(::operator new(7, std::nothrow));
  EXPECT_EQ(counter.count(), 3u);
}

TEST(AllocationCounter, IgnoresOtherThreads) {
  std::uint64_t seen = 1;
  std::thread other;
  {
    const AllocationCounter outer;
    other = std::thread([] { std::vector<int> theirs(1000); });
    const std::uint64_t for_the_thread = outer.count();  // std::thread takes its own state
    other.join();
    seen = outer.count() - for_the_thread;
  }
  EXPECT_EQ(seen, 0u);
}

}  // namespace
}  // namespace sonoband::test
