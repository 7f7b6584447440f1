#include "hal/clock.h"

namespace sonoband {

Stamp SystemClock::now() {
  return Stamp(std::chrono::steady_clock::now().time_since_epoch());
}

void SystemClock::sleep_until(Stamp t) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(t.time_since_epoch()));
}

ClockThread::ClockThread(Clock& clock, std::function<void()> body)
    : clock_(&clock), thread_([&clock, member = clock.join(), body = std::move(body)] {
        clock.enter(member);
        body();
        clock.leave(member);
      }) {}

void ClockThread::join() {
  if (!thread_.joinable()) return;
  const ClockAway away(*clock_);
  thread_.join();
}

}  // namespace sonoband
