#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/concurrency/latest.h"
#include "core/concurrency/spsc_queue.h"
#include "tests/support/allocation_counter.h"

namespace sonoband {
namespace {

// Knows whether it is alive, and how many of its kind are.
class Tracked {
 public:
  static inline std::atomic<int> alive{0};

  explicit Tracked(int v) : value(v), self_(this) { count(1); }
  Tracked(const Tracked& o) : value(o.value), self_(this) { count(1); }
  Tracked& operator=(const Tracked&) = delete;
  ~Tracked() {
    EXPECT_EQ(self_, this) << "destroyed twice, or never made";
    self_ = nullptr;
    count(-1);
  }
  bool sound() const { return self_ == this; }
  int value;

 private:
  // Relaxed, so that the count itself orders nothing between the threads.
  static void count(int change) { alive.fetch_add(change, std::memory_order_relaxed); }
  Tracked* self_;
};

TEST(SpscQueue, RefusesWhenFullAndKeepsOrderAcrossTheWrap) {
  {
    SpscQueue<Tracked> queue(3);
    EXPECT_EQ(queue.front(), nullptr);
    int in = 0;
    int out = 0;
    for (int round = 0; round < 10; ++round) {
      while (queue.try_emplace(in)) ++in;
      EXPECT_EQ(in - out, 3);
      EXPECT_EQ(Tracked::alive, 3);
      for (int k = 0; k < 2; ++k) {
        ASSERT_NE(queue.front(), nullptr);
        EXPECT_TRUE(queue.front()->sound());
        EXPECT_EQ(queue.front()->value, out++);
        queue.pop();
      }
    }
    EXPECT_GT(Tracked::alive, 0);
  }
  EXPECT_EQ(Tracked::alive, 0) << "the queue destroys what it still holds";
}

TEST(SpscQueue, TwoThreadsSeeEveryElementOnceInOrder) {
  constexpr int count = 20000;
  {
    SpscQueue<Tracked> queue(7);
    std::thread producer([&] {
      for (int i = 0; i < count;) {
        if (queue.try_emplace(i))
          ++i;
        else
          std::this_thread::yield();
      }
    });
    for (int expected = 0; expected < count;) {
      const Tracked* front = queue.front();
      if (front == nullptr) {
        std::this_thread::yield();
        continue;
      }
      ASSERT_TRUE(front->sound());
      ASSERT_EQ(front->value, expected++);
      queue.pop();
    }
    EXPECT_EQ(queue.front(), nullptr);
    producer.join();
  }
  EXPECT_EQ(Tracked::alive, 0);
}

TEST(SpscQueue, TakesNoHeapOnceMade) {
  SpscQueue<int> queue(4);
  const test::AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(queue.try_emplace(i));
    queue.pop();
  }
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(Latest, TheNewestWinsAndTheReplacedAreCounted) {
  Latest<int> box;
  EXPECT_EQ(box.take(), nullptr);
  box.put(1);
  box.put(2);
  box.put(3);
  ASSERT_NE(box.take(), nullptr);
  EXPECT_EQ(box.take(), nullptr) << "taken once";
  EXPECT_EQ(box.replaced(), 2U);
  box.put(4);
  const int* taken = box.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 4);
  box.put(5);
  box.put(6);
  EXPECT_EQ(*taken, 4) << "what was taken stays until the next take";
  EXPECT_EQ(*box.take(), 6);
  EXPECT_EQ(box.replaced(), 3U);
}

TEST(Latest, TwoThreadsNeverSeeATornOrAnOlderValueAndTheCountsAddUp) {
  // Wide enough that a torn copy would show.
  struct Wide {
    std::uint64_t words[16] = {};
  };
  constexpr std::uint64_t count = 20000;
  Latest<Wide> box;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    Wide w;
    for (std::uint64_t i = 1; i <= count; ++i) {
      for (auto& word : w.words) word = i;
      box.put(w);
      if (i % 64 == 0) std::this_thread::yield();
    }
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t taken = 0;
  for (bool over = false; !over;) {
    over = done;
    while (const Wide* w = box.take()) {
      for (const auto word : w->words) ASSERT_EQ(word, w->words[0]);
      ASSERT_GT(w->words[0], last);
      last = w->words[0];
      ++taken;
    }
    std::this_thread::yield();
  }
  writer.join();
  EXPECT_EQ(last, count);
  EXPECT_EQ(taken + box.replaced(), count);
}

}  // namespace
}  // namespace sonoband
