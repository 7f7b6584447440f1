// A cart without devices: events with their own times and their times of arrival, delivered in order of
// arrival as the appliance's thread would.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "app/cart/cart.h"

namespace sonoband::cart::test {

inline Stamp at_ms(double ms) {
  return Stamp(from_seconds(ms / 1000));
}

constexpr int source_width = 24;
constexpr int source_height = 18;

inline RingSettings small_ring(std::uint32_t slots) {
  return {.width = 16, .height = 10, .slots = slots, .reserve = 24, .sweeps = 4, .leases = 4};
}

inline CartSettings small_cart() {
  CartSettings s;
  s.acquisition.source_width = source_width;
  s.acquisition.source_height = source_height;
  s.acquisition.crop = {4, 5, false, false};
  s.acquisition.readings = 512;
  return s;
}

// A picture that differs from its neighbours in time by many grey levels everywhere.
struct Picture {
  std::vector<std::uint8_t> bytes;
  explicit Picture(std::uint64_t n) : bytes(source_width * source_height) {
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(i * 7 + (n % 2 == 0 ? 0 : 100) + n % 19);
  }
  Frame frame(std::uint64_t n, Stamp captured, Stamp arrived) const {
    Frame f;
    f.data = bytes.data();
    f.bytes = bytes.size();
    f.width = source_width;
    f.height = source_height;
    f.stride_bytes = source_width;
    f.captured = captured;
    f.arrived = arrived;
    f.sequence = n;
    return f;
  }
};

inline PoseSample reading(Stamp t) {
  PoseSample s;
  s.time = t;
  s.tracker_from_probe.translation = {0, 0, 20 * seconds(t)};
  s.quality = PoseQuality::good;
  return s;
}

class Timeline {
 public:
  void at(Stamp arrival, std::function<void(Cart&, Stamp)> what) {
    events_.push_back({arrival, std::move(what)});
  }
  void frames(double hz, Stamp from, Stamp to, Duration delay, std::uint64_t first_number = 1) {
    std::uint64_t n = first_number;
    for (Stamp t = from; t < to; t += from_seconds(1 / hz), ++n) {
      at(t + delay, [n, t](Cart& cart, Stamp now) { cart.on_frame(Picture(n).frame(n, t, now), now); });
      captured.push_back(t);
    }
  }
  void poses(Stamp from, Stamp to, Duration delay) {
    for (Stamp t = from; t < to; t += from_seconds(1.0 / 240))
      at(t + delay, [t](Cart& cart, Stamp now) { cart.on_pose(reading(t), now); });
  }
  // A contact that closes or opens and bounces for 6 ms.
  void edge(Stamp t, bool closed, Duration delay) {
    const int after_ms[] = {0, 1, 2, 5, 6};
    for (int i = 0; i < 5; ++i) {
      PedalEdge e;
      e.time = t + std::chrono::milliseconds(after_ms[i]);
      e.closed = i % 2 == 0 ? closed : !closed;
      e.sequence = ++edges_;
      at(e.time + delay, [e](Cart& cart, Stamp now) { cart.on_edge(e, now); });
    }
  }
  // The pedal's level when it starts: up, so that the next press counts.
  void pedal_is_up(Stamp t) {
    PedalEdge e;
    e.time = t;
    at(t, [e](Cart& cart, Stamp now) { cart.on_edge(e, now); });
  }

  // Delivers everything, with a tick every 5 ms, and goes on ticking until `end`.
  void run(Cart& cart, Stamp end, const std::function<void(Stamp)>& after_each_tick = {}) {
    std::stable_sort(events_.begin(), events_.end(),
                     [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
    Stamp tick = events_.front().arrival;
    std::size_t next = 0;
    for (; tick < end; tick += std::chrono::milliseconds(5)) {
      for (; next < events_.size() && events_[next].arrival <= tick; ++next)
        events_[next].what(cart, events_[next].arrival);
      cart.tick(tick);
      if (after_each_tick) after_each_tick(tick);
    }
  }

  std::vector<Stamp> captured;  // of all frames made

 private:
  struct Event {
    Stamp arrival{};
    std::function<void(Cart&, Stamp)> what;
  };
  std::vector<Event> events_;
  std::uint64_t edges_ = 0;
};

}  // namespace sonoband::cart::test
