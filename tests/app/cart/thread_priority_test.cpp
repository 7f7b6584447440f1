// Real-time priority: had, inherited and given back; and what is said where the system refuses it.
#include "app/cart/thread_priority.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <thread>

namespace sonoband::cart {
namespace {

struct Scheduling {
  int policy = 0;
  int priority = 0;
  bool operator==(const Scheduling&) const = default;
};

Scheduling of_this_thread() {
  Scheduling now;
  sched_param param{};
  pthread_getschedparam(pthread_self(), &now.policy, &param);
  now.priority = param.sched_priority;
  return now;
}

TEST(ThreadPriority, IsInheritedByThreadsAndGivenBackAtTheEnd) {
  const Scheduling before = of_this_thread();
  Scheduling inside;
  Scheduling of_a_thread;
  {
    const BeforeOthers raised(40);
    if (!raised.warning().empty())
      GTEST_SKIP() << "this takes a limit of real-time priority: " << raised.warning();
    inside = of_this_thread();
    std::thread([&] { of_a_thread = of_this_thread(); }).join();
  }
  EXPECT_EQ(inside, (Scheduling{SCHED_RR, 40}));
  EXPECT_EQ(of_a_thread, inside);
  EXPECT_EQ(of_this_thread(), before);
}

TEST(ThreadPriority, ZeroLeavesEverythingAsItIs) {
  const Scheduling before = of_this_thread();
  const BeforeOthers none(0);
  EXPECT_EQ(none.warning(), "");
  EXPECT_EQ(of_this_thread(), before);
}

// In a process of its own, that of a user who may not.
void ask_without_the_right() {
  const rlimit nothing{0, 0};
  if (setrlimit(RLIMIT_RTPRIO, &nothing) != 0 || (getuid() == 0 && setuid(65534) != 0)) std::exit(3);
  const Scheduling before = of_this_thread();
  const BeforeOthers refused(40);
  std::fprintf(stderr, "%s\n", refused.warning().c_str());
  std::exit(of_this_thread() == before ? 0 : 4);
}

TEST(ThreadPriorityDeathTest, RefusedItSaysTheCureAndGoesOn) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(ask_without_the_right(), testing::ExitedWithCode(0),
              "Acquisition has no real-time priority .*raise the limit with .ulimit -r. or LimitRTPRIO=");
}

}  // namespace
}  // namespace sonoband::cart
