// Time that jumps: a simulated examination of a minute runs in as long as its computing takes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <thread>

#include "hal/clock.h"

namespace sonoband::sim {

// Members are the threads that time waits for. While any of them is awake time stands still; when all of them
// sleep, the one with the earliest deadline (of equal ones the one that joined first) is woken at its
// deadline, alone. So one member runs at a time and a run is the same every time.
//
// A thread that is not a member may sleep too; it is woken in turn but time does not wait for it afterwards.
// A member that waits for anything but this clock (a mailbox, a thread's end) must be away meanwhile, or time
// stands still for ever.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(Stamp start = Stamp(std::chrono::seconds(1000))) : now_(start.time_since_epoch()) {}
  ~VirtualClock() override;

  Stamp now() override { return Stamp(now_.load(std::memory_order_acquire)); }
  void sleep_until(Stamp t) override;

  int join() override;
  void enter(int member) override;
  void leave(int member) override;
  int step_away() override;
  void come_back(int member) override;

  // Wakes every sleeper. From then on sleep_until moves time to its deadline and returns at once, so that a
  // loop that waits for a deadline ends.
  void stop();

 private:
  struct Sleeper {
    Stamp deadline;
    int member;  // -1: not a member
    std::condition_variable woken;
    bool awake = false;
  };
  void advance();  // under mutex_
  int member_of_caller() const;

  mutable std::mutex mutex_;
  std::atomic<Duration> now_;
  std::map<std::thread::id, int> members_;  // those that have entered
  std::list<Sleeper*> sleepers_;            // in order of deadline, then member, then arrival
  int next_member_ = 0;
  int awake_ = 0;  // members that time waits for
  bool stopped_ = false;
};

}  // namespace sonoband::sim
