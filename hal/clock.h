// Reading time and waiting for it. Only hal and app may.
#pragma once

#include <functional>
#include <thread>

#include "core/time.h"

namespace sonoband {

// A simulated clock (hal/sim/virtual_clock.h) has to know whom to wait for before it jumps; on the real one
// the calls about members do nothing. Use ClockThread and ClockAway below rather than these.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual Stamp now() = 0;
  virtual void sleep_until(Stamp t) = 0;  // returns at once if t has passed

  virtual int join() { return 0; }           // one more member, awake from now on; by the thread's starter
  virtual void enter(int /*member*/) {}      // the calling thread is that member
  virtual void leave(int /*member*/) {}      // it is a member no more; by the member itself
  virtual int step_away() { return 0; }      // the caller waits for something else; gives its member
  virtual void come_back(int /*member*/) {}  // and is through waiting
};

// CLOCK_MONOTONIC.
class SystemClock final : public Clock {
 public:
  Stamp now() override;
  void sleep_until(Stamp t) override;
};

// Around a wait for anything but the clock: a queue, a mailbox, the end of a thread.
class ClockAway {
 public:
  explicit ClockAway(Clock& clock) : clock_(clock), member_(clock.step_away()) {}
  ~ClockAway() { clock_.come_back(member_); }
  ClockAway(const ClockAway&) = delete;
  ClockAway& operator=(const ClockAway&) = delete;

 private:
  Clock& clock_;
  int member_;
};

// A thread that sleeps on the clock. The clock must outlive it.
class ClockThread {
 public:
  ClockThread() = default;
  ClockThread(Clock& clock, std::function<void()> body);
  ClockThread(ClockThread&&) noexcept = default;
  ClockThread& operator=(ClockThread&&) noexcept = default;
  ~ClockThread() { join(); }

  void join();  // waits for the body's end, away from the clock; nothing to do the second time

 private:
  Clock* clock_ = nullptr;
  std::thread thread_;
};

// Makes the calling thread a member while it lives: for main, which starts the others.
class ClockMember {
 public:
  explicit ClockMember(Clock& clock) : clock_(clock), member_(clock.join()) { clock.enter(member_); }
  ~ClockMember() { clock_.leave(member_); }
  ClockMember(const ClockMember&) = delete;
  ClockMember& operator=(const ClockMember&) = delete;

 private:
  Clock& clock_;
  int member_;
};

}  // namespace sonoband
