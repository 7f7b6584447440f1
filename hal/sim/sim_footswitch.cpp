#include "hal/sim/sim_footswitch.h"

#include <algorithm>

#include "hal/sim/random.h"

namespace sonoband::sim {

namespace {

// How soon a live press is noticed. Its stamp is when it was pressed, so this delays nothing but the news.
constexpr Duration look = std::chrono::milliseconds(4);

}  // namespace

SimFootswitch::SimFootswitch(Clock& clock, const FootswitchSettings& settings)
    : clock_(clock), settings_(settings) {}

void SimFootswitch::start() {
  const Stamp now = clock_.now();
  origin_ = settings_.origin.value_or(now);
  contact_ = settings_.held_at_start;
  report_level_ = now;
  plugged_ = true;
  sequence_ = 0;
  script_ = {};
  live_ = {};
  for (const PedalPress& p : settings_.script) {
    add_bouncing(script_, origin_ + p.press, true);
    add_bouncing(script_, origin_ + p.release, false);
  }
  health_.state = DeviceState::running;
}

void SimFootswitch::stop() {
  health_.state = DeviceState::absent;
}

// The contact closes (or opens) at `time` and then swings back an even number of times; what an earlier
// change would still have bounced is over.
void SimFootswitch::add_bouncing(Course& to, Stamp time, bool closed) {
  const auto draw = [this] { return uniform(settings_.seed, drawn_++); };
  while (to.changes.size() > to.next && to.changes.back().time > time) to.changes.pop_back();
  to.changes.push_back({time, closed});
  const int most = settings_.bounces / 2 + 1;
  const int swings = 2 * static_cast<int>(draw() * most);
  std::vector<double> moments;
  moments.reserve(static_cast<std::size_t>(swings));
  for (int i = 0; i < swings; ++i) moments.push_back(draw());
  std::sort(moments.begin(), moments.end());
  for (int i = 0; i < swings; ++i) {
    const Duration after =
        from_seconds(seconds(settings_.bounce_time) * moments[static_cast<std::size_t>(i)]);
    to.changes.push_back({time + after, (i % 2 == 0) != closed});
  }
}

bool SimFootswitch::press() {
  if (settings_.on_live_press) settings_.on_live_press(clock_.now());
  return inject(true);
}

bool SimFootswitch::release() {
  return inject(false);
}

bool SimFootswitch::inject(bool closed) {
  const std::uint64_t w = written_.load(std::memory_order_relaxed);
  if (w - taken_.load(std::memory_order_acquire) == queue_size) return false;
  queue_[w % queue_size] = {clock_.now(), closed};
  written_.store(w + 1, std::memory_order_release);
  return true;
}

void SimFootswitch::take_live() {
  std::uint64_t t = taken_.load(std::memory_order_relaxed);
  const std::uint64_t w = written_.load(std::memory_order_acquire);
  if (t == w) return;
  live_.changes.erase(live_.changes.begin(), live_.changes.begin() + static_cast<std::ptrdiff_t>(live_.next));
  live_.next = 0;
  for (; t != w; ++t) add_bouncing(live_, queue_[t % queue_size].time, queue_[t % queue_size].closed);
  taken_.store(t, std::memory_order_release);
}

const SimFootswitch::Change* SimFootswitch::next_change() const {
  const Change* s = script_.next < script_.changes.size() ? &script_.changes[script_.next] : nullptr;
  const Change* l = live_.next < live_.changes.size() ? &live_.changes[live_.next] : nullptr;
  return l == nullptr || (s != nullptr && s->time <= l->time) ? s : l;
}

void SimFootswitch::step_over() {
  const Change* c = next_change();
  Course& course =
      script_.next < script_.changes.size() && c == &script_.changes[script_.next] ? script_ : live_;
  ++course.next;
}

const PedalFault* SimFootswitch::fault_at(Stamp t) const {
  for (const PedalFault& f : settings_.faults) {
    if (t >= origin_ + f.from && t < origin_ + f.until) return &f;
  }
  return nullptr;
}

ReadStatus SimFootswitch::deliver(PedalEdge& out, Stamp time, bool closed) {
  out = {.time = time, .closed = closed, .pedal = 0, .sequence = sequence_++};
  ++health_.delivered;
  return ReadStatus::ok;
}

ReadStatus SimFootswitch::read(PedalEdge& out, Duration timeout) {
  const Stamp deadline = clock_.now() + timeout;
  for (;;) {
    const Stamp now = clock_.now();
    take_live();

    const PedalFault* fault = fault_at(now);
    const bool plugged = fault == nullptr || fault->kind != PedalFault::Kind::unplug;
    if (plugged != plugged_) {
      plugged_ = plugged;
      health_.state = plugged ? DeviceState::running : DeviceState::absent;
      if (plugged) {
        ++health_.recoveries;
        report_level_ = now;
        sequence_ = 0;
      }
    }

    for (const Change* next = next_change(); next != nullptr && next->time <= now; next = next_change()) {
      const Change c = *next;
      const PedalFault* then = fault_at(c.time);
      if (report_level_ && plugged_ && c.time >= *report_level_) break;  // the level before it comes first
      step_over();
      if (c.closed == contact_) continue;  // pressed while down: no edge
      contact_ = c.closed;
      if (report_level_) continue;
      if (then == nullptr) return deliver(out, c.time, c.closed);
      if (then->kind == PedalFault::Kind::lose_edges) {
        ++sequence_;
        ++health_.lost;
      }
    }
    if (report_level_ && plugged_) {
      const Stamp since = *report_level_;
      report_level_.reset();
      return deliver(out, since, contact_);
    }

    if (now >= deadline) return ReadStatus::nothing_yet;
    Stamp wake = std::min(deadline, now + look);
    if (const Change* next = next_change()) wake = std::min(wake, next->time);
    clock_.sleep_until(wake);
  }
}

DeviceHealth SimFootswitch::health() const {
  DeviceHealth h = health_.read();
  if (h.state == DeviceState::absent) h.reason = "The footswitch is not connected: plug it in.";
  return h;
}

}  // namespace sonoband::sim
