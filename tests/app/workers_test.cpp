#include "app/workers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <vector>

namespace sonoband {
namespace {

TEST(Workers, DoEachPartOfEachJobOnce) {
  for (const int threads : {1, 2, 5}) {
    Workers workers(threads);
    EXPECT_EQ(workers.width(), threads);
    for (int job = 0; job < 300; ++job) {
      const int count = job % 37;
      std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
      workers.for_each(count, [&](int i) { ++done[static_cast<std::size_t>(i)]; });
      for (const std::atomic<int>& times : done) ASSERT_EQ(times, 1) << "job " << job;
    }
  }
}

// A thread may wake for the last job when all of it is done and the pool ends: the thread sanitizer saw it
// read what the end wrote.
TEST(Workers, EndWhileOneIsLateForTheLastJob) {
  for (int i = 0; i < 500; ++i) {
    std::atomic<int> sum{0};
    Workers workers(3);
    const auto until =
        std::chrono::steady_clock::now() + std::chrono::microseconds(i);  // waking takes some 50
    workers.for_each(2, [&](int part) {
      while (std::chrono::steady_clock::now() < until) {
      }
      sum += part + 1;
    });
    ASSERT_EQ(sum, 3);
  }
}

}  // namespace
}  // namespace sonoband
