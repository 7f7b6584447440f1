#include "hal/sim/virtual_clock.h"

#include <gtest/gtest.h>

#include <atomic>
#include <utility>
#include <vector>

namespace sonoband::sim {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

TEST(VirtualClock, JumpsToTheDeadlineOfALoneSleeper) {
  VirtualClock clock(Stamp(hours(1)));
  clock.sleep_until(Stamp(hours(2)));
  EXPECT_EQ(clock.now(), Stamp(hours(2)));
  clock.sleep_until(Stamp(hours(1)));  // passed: time never goes back
  EXPECT_EQ(clock.now(), Stamp(hours(2)));
}

using Log = std::vector<std::pair<Stamp, int>>;

// Members that wake every `period` ms of their own and note when they did.
Log wakes(const std::vector<int>& periods) {
  VirtualClock clock{Stamp{}};
  Log log;  // no mutex: one member runs at a time, which the thread sanitizer then checks
  {
    const ClockMember main(clock);
    std::vector<ClockThread> threads;
    for (std::size_t i = 0; i < periods.size(); ++i) {
      threads.emplace_back(clock, [&, i] {
        for (int n = 1; n * periods[i] <= 120; ++n) {
          clock.sleep_until(Stamp(milliseconds(n * periods[i])));
          log.emplace_back(clock.now(), static_cast<int>(i));
        }
      });
    }
    for (ClockThread& t : threads) t.join();
  }
  return log;
}

TEST(VirtualClock, WakesMembersOneByOneInOrderOfDeadlineThenOfJoining) {
  const Log log = wakes({7, 5, 12, 5});
  Log expected;
  for (int ms = 1; ms <= 120; ++ms) {
    const std::vector<int> periods{7, 5, 12, 5};
    for (int i = 0; i < 4; ++i) {
      if (ms % periods[static_cast<std::size_t>(i)] == 0) expected.emplace_back(Stamp(milliseconds(ms)), i);
    }
  }
  EXPECT_EQ(log, expected);
}

TEST(VirtualClock, StandsStillWhileAMemberIsAwake) {
  VirtualClock clock{Stamp{}};
  const ClockMember main(clock);
  std::atomic<bool> woken = false;
  ClockThread sleeper(clock, [&] {
    clock.sleep_until(Stamp(milliseconds(10)));
    woken = true;
  });
  clock.sleep_until(Stamp(milliseconds(9)));
  EXPECT_EQ(clock.now(), Stamp(milliseconds(9)));
  EXPECT_FALSE(woken);
  sleeper.join();
  EXPECT_TRUE(woken);
  EXPECT_EQ(clock.now(), Stamp(milliseconds(10)));
}

TEST(VirtualClock, StopWakesSleepersAndLetsLoopsEnd) {
  VirtualClock clock{Stamp{}};
  const ClockMember main(clock);
  std::vector<ClockThread> sleepers;
  for (int i = 0; i < 3; ++i) {
    sleepers.emplace_back(clock, [&clock, i] {
      for (int n = 0; n < 10; ++n) clock.sleep_until(clock.now() + hours(1 + i));
    });
  }
  clock.stop();
  for (ClockThread& t : sleepers) t.join();
  const Stamp deadline = clock.now() + hours(5);
  clock.sleep_until(deadline);
  EXPECT_EQ(clock.now(), deadline);
}

TEST(VirtualClock, AStrangerSleepsButHoldsNothingUp) {
  VirtualClock clock{Stamp{}};
  std::vector<Stamp> ticks;
  ClockThread member(clock, [&] {
    for (int n = 1; n <= 5; ++n) {
      clock.sleep_until(Stamp(milliseconds(10 * n)));
      ticks.push_back(clock.now());
    }
  });
  clock.sleep_until(Stamp(milliseconds(25)));
  EXPECT_GE(clock.now(), Stamp(milliseconds(25)));
  member.join();
  EXPECT_EQ(ticks.size(), 5U);
  EXPECT_EQ(ticks.back(), Stamp(milliseconds(50)));
}

TEST(VirtualClock, AnAwayMemberDoesNotHoldTimeUp) {
  VirtualClock clock{Stamp{}};
  const ClockMember main(clock);
  std::atomic<int> done = 0;
  ClockThread other(clock, [&] {
    clock.sleep_until(Stamp(milliseconds(10)));
    done = 1;
    done.notify_all();
  });
  {
    const ClockAway away(clock);
    done.wait(0);
  }
  EXPECT_EQ(clock.now(), Stamp(milliseconds(10)));
}

}  // namespace
}  // namespace sonoband::sim
