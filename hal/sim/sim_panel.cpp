#include "hal/sim/sim_panel.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace sonoband::sim {
namespace {

std::int32_t unit_of(double part, const TouchRange& range) {
  const double units = 1.0 + range.most - double{1.0} * range.least;
  const double value = std::floor(std::clamp(part, 0.0, 1.0) * units);
  return range.least + static_cast<std::int32_t>(std::min(value, units - 1));
}

}  // namespace

SimPanel::SimPanel(Clock& clock, const SimPanelSettings& settings) : clock_(clock), settings_(settings) {}

void SimPanel::say(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  if (open_) waiting_.push_back({type, code, value, clock_.now().time_since_epoch().count()});
}

void SimPanel::choose(int slot) {
  if (std::exchange(slot_, slot) != slot) say(EV_ABS, ABS_MT_SLOT, slot);
}

void SimPanel::touch(int finger, double x, double y, double major_mm) {
  assert(finger >= 0 && finger < most_fingers);
  Slot& slot = slots_[static_cast<std::size_t>(finger)];
  const Slot now{.id = slot.id,
                 .x = unit_of(x, settings_.x),
                 .y = unit_of(y, settings_.y),
                 .major = static_cast<std::int32_t>(std::lround(major_mm * settings_.major.per_mm))};
  choose(finger);
  if (slot.id < 0) {
    slot.id = next_id_++ & 0xffff;
    say(EV_ABS, ABS_MT_TRACKING_ID, slot.id);
  }
  // The kernel tells only what changed, and remembers a slot's values from one finger to the next.
  if (std::exchange(slot.x, now.x) != now.x) say(EV_ABS, ABS_MT_POSITION_X, now.x);
  if (std::exchange(slot.y, now.y) != now.y) say(EV_ABS, ABS_MT_POSITION_Y, now.y);
  if (std::exchange(slot.major, now.major) != now.major) say(EV_ABS, ABS_MT_TOUCH_MAJOR, now.major);
  say(EV_SYN, SYN_REPORT, 0);
}

void SimPanel::lift(int finger) {
  assert(finger >= 0 && finger < most_fingers);
  if (std::exchange(slots_[static_cast<std::size_t>(finger)].id, -1) < 0) return;
  choose(finger);
  say(EV_ABS, ABS_MT_TRACKING_ID, -1);
  say(EV_SYN, SYN_REPORT, 0);
}

void SimPanel::drop() {
  waiting_.clear();
  say(EV_SYN, SYN_DROPPED, 0);
  for (int s = 0; s < most_fingers; ++s) {
    const Slot& slot = slots_[static_cast<std::size_t>(s)];
    say(EV_ABS, ABS_MT_SLOT, s);
    say(EV_ABS, ABS_MT_TRACKING_ID, slot.id);
    say(EV_ABS, ABS_MT_POSITION_X, slot.x);
    say(EV_ABS, ABS_MT_POSITION_Y, slot.y);
    say(EV_ABS, ABS_MT_TOUCH_MAJOR, slot.major);
  }
  say(EV_ABS, ABS_MT_SLOT, slot_);
  say(EV_SYN, SYN_REPORT, 0);
}

TouchStatus SimPanel::open(TouchPanel& panel) {
  close();
  if (!plugged_) return TouchStatus::absent;
  if (refusal_ != TouchStatus::ok) return refusal_;
  panel = {.name = "Simulated panel",
           .path = "simulated",
           .protocol = TouchPanel::Protocol::slots,
           .x = settings_.x,
           .y = settings_.y,
           .major = settings_.major};
  open_ = true;
  for (int s = 0; s < most_fingers; ++s) {
    const Slot& slot = slots_[static_cast<std::size_t>(s)];
    say(EV_ABS, ABS_MT_SLOT, s);
    say(EV_ABS, ABS_MT_POSITION_X, slot.x);
    say(EV_ABS, ABS_MT_POSITION_Y, slot.y);
    say(EV_ABS, ABS_MT_TOUCH_MAJOR, slot.major);
  }
  say(EV_ABS, ABS_MT_SLOT, slot_);
  return TouchStatus::ok;
}

TouchStatus SimPanel::wait(RawTouch& out, Duration timeout) {
  if (!plugged_) return TouchStatus::gone;
  if (waiting_.empty()) {
    clock_.sleep_until(clock_.now() + timeout);
    return TouchStatus::nothing_yet;
  }
  out = waiting_.front();
  waiting_.pop_front();
  return TouchStatus::ok;
}

void SimPanel::close() {
  open_ = false;
  waiting_.clear();
}

}  // namespace sonoband::sim
