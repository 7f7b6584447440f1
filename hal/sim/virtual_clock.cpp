#include "hal/sim/virtual_clock.h"

#include <algorithm>
#include <cassert>

namespace sonoband::sim {

VirtualClock::~VirtualClock() {
  assert(sleepers_.empty());
}

void VirtualClock::sleep_until(Stamp t) {
  std::unique_lock lock(mutex_);
  if (t <= now()) return;
  if (stopped_) {
    now_ = t.time_since_epoch();
    return;
  }
  Sleeper me{t, member_of_caller(), {}};
  const auto later = [&](const Sleeper* s) {
    return s->deadline > t || (s->deadline == t && s->member > me.member);
  };
  sleepers_.insert(std::find_if(sleepers_.begin(), sleepers_.end(), later), &me);
  if (me.member >= 0) --awake_;
  advance();
  me.woken.wait(lock, [&] { return me.awake; });
}

void VirtualClock::advance() {
  while (awake_ == 0 && !sleepers_.empty() && !stopped_) {
    Sleeper& first = *sleepers_.front();
    sleepers_.pop_front();
    now_ = std::max(now_.load(), first.deadline.time_since_epoch());
    if (first.member >= 0) ++awake_;
    first.awake = true;
    first.woken.notify_one();
  }
}

int VirtualClock::join() {
  const std::lock_guard lock(mutex_);
  ++awake_;
  return next_member_++;
}

void VirtualClock::enter(int member) {
  const std::lock_guard lock(mutex_);
  [[maybe_unused]] const bool first = members_.emplace(std::this_thread::get_id(), member).second;
  assert(first);
}

void VirtualClock::leave(int member) {
  const std::lock_guard lock(mutex_);
  assert(member_of_caller() == member);
  static_cast<void>(member);
  members_.erase(std::this_thread::get_id());
  --awake_;
  advance();
}

int VirtualClock::step_away() {
  const std::lock_guard lock(mutex_);
  const int member = member_of_caller();
  if (member >= 0) {
    --awake_;
    advance();
  }
  return member;
}

void VirtualClock::come_back(int member) {
  const std::lock_guard lock(mutex_);
  if (member >= 0) ++awake_;
}

void VirtualClock::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  for (Sleeper* s : sleepers_) {
    if (s->member >= 0) ++awake_;
    s->awake = true;
    s->woken.notify_one();
  }
  sleepers_.clear();
}

int VirtualClock::member_of_caller() const {
  const auto found = members_.find(std::this_thread::get_id());
  return found == members_.end() ? -1 : found->second;
}

}  // namespace sonoband::sim
