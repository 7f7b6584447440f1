#include "hal/touch/touchscreen.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <utility>

namespace sonoband {
namespace {

constexpr Duration look_again = std::chrono::seconds(1);
constexpr Duration believable_age = std::chrono::seconds(1);
// Events read after the time ran out, so that packets come whole even with no time to wait; more is a panel
// that never pauses.
constexpr int most_late = 1024;

}  // namespace

const char* sentence_of(TouchStatus status) {
  switch (status) {
    case TouchStatus::ok:
    case TouchStatus::nothing_yet:
      return "";
    case TouchStatus::absent:
      return "No touchscreen: plug its USB cable in, or name it in touch.device; a mouse works as well.";
    case TouchStatus::access_denied:
      return "The touchscreen may not be read: install board/udev/70-sonoband.rules and plug it in again.";
    case TouchStatus::busy:
      return "Another program holds the touchscreen: close it.";
    case TouchStatus::gone:
      return "The touchscreen is gone: plug its USB cable in again; a mouse works meanwhile.";
  }
  return "";
}

Touchscreen::Touchscreen(std::unique_ptr<TouchPort> port, Clock& clock, const TouchMapping& mapping)
    : port_(std::move(port)), clock_(clock), mapping_(mapping) {}

Touchscreen::~Touchscreen() {
  Touchscreen::stop();
}

void Touchscreen::start() {
  if (started_) return;
  started_ = true;
  health_.delivered = 0;
  next_open_ = clock_.now();
  health_.say(DeviceState::starting, "");
}

void Touchscreen::stop() {
  started_ = false;
  port_->close();
  open_ = false;
  contacts_.begin(panel_, mapping_);
  health_.say(DeviceState::absent, "");
}

void Touchscreen::connect() {
  next_open_ = clock_.now() + look_again;
  const TouchStatus status = port_->open(panel_);
  open_ = status == TouchStatus::ok;
  if (open_) {
    contacts_.begin(panel_, mapping_);
    health_.say(DeviceState::running, "");
  } else if (status != TouchStatus::absent || health_.read().recoveries == 0) {
    // Of one that was there it stays said that it is gone.
    health_.say(status == TouchStatus::absent ? DeviceState::absent : DeviceState::fault,
                sentence_of(status));
  }
}

// A finger on glass that is gone has lifted: nothing may be dragged for ever because a cable fell out.
void Touchscreen::lose() {
  port_->close();
  open_ = false;
  next_open_ = clock_.now() + look_again;
  health_.recoveries.fetch_add(1, std::memory_order_relaxed);
  health_.say(DeviceState::absent, sentence_of(TouchStatus::gone));
  contacts_.lift_all(clock_.now());
}

void Touchscreen::take(const RawTouch& raw) {
  if (raw.type == EV_SYN && raw.code == SYN_DROPPED) health_.lost.fetch_add(1, std::memory_order_relaxed);
  const Stamp now = clock_.now();
  Stamp time{std::chrono::nanoseconds(raw.stamp_ns)};
  if (time > now || now - time > believable_age) time = now;
  contacts_.feed(raw, time);
}

ReadStatus Touchscreen::read(TouchEvent& out, Duration timeout) {
  if (!started_) return ReadStatus::ended;
  const Stamp until = clock_.now() + timeout;
  for (int late = 0;;) {
    if (contacts_.take(out)) {
      health_.delivered.fetch_add(1, std::memory_order_relaxed);
      return ReadStatus::ok;
    }
    const Stamp now = clock_.now();
    if (!open_ && now >= next_open_) {
      connect();
      continue;
    }
    if (!open_) {
      if (now >= until) return ReadStatus::nothing_yet;
      clock_.sleep_until(std::min(until, next_open_));
      continue;
    }
    RawTouch raw;
    const TouchStatus status = port_->wait(raw, std::max(until - now, Duration::zero()));
    if (status == TouchStatus::ok) {
      take(raw);
      if (now >= until && ++late == most_late) return ReadStatus::nothing_yet;
    } else if (status != TouchStatus::nothing_yet) {
      lose();
    } else if (now >= until) {
      return ReadStatus::nothing_yet;
    }
  }
}

DeviceHealth Touchscreen::health() const {
  return health_.read();
}

}  // namespace sonoband
