#include "core/manifold/route_map.h"

#include <cmath>
#include <queue>

namespace sonoband::flow {

namespace {

constexpr double fastest = 50;         // 1 / sin(theta) of a vertex normal 1.1 degrees off its edges
constexpr double fastest_shock = 1e9;  // a shock between edges that face each other: they vanish at once

// An edge of the moving front: the part [from, to] of its parallel, whose ends move at constant rates.
struct Moving {
  double from = 0, to = 0;            // at time `since`
  double from_rate = 0, to_rate = 0;  // per unit of time
  double since = 0;
  int before = -1, after = -1;  // living neighbours, -1 at an open end
  int version = 0;              // events of older versions are void
  bool alive = true;

  double from_at(double t) const { return from + from_rate * (t - since); }
  double to_at(double t) const { return to + to_rate * (t - since); }
};

// Edge `edge` has length zero at `time`. Of equal times the lower edge goes first.
struct Event {
  double time;
  int edge;
  int version;
  bool operator>(const Event& other) const {
    return time != other.time ? time > other.time : edge > other.edge;
  }
};

class RouteMap {
 public:
  explicit RouteMap(const Side& side) : side_(side), moving_(side.edges.size()) {
    const int edges = static_cast<int>(moving_.size());
    living_ = edges;
    for (int e = 0; e < edges; ++e) {
      Moving& m = moving_[e];
      m.to = side.edges[e].length;
      m.before = e > 0 ? e - 1 : side.closed ? edges - 1 : -1;
      m.after = e + 1 < edges ? e + 1 : side.closed ? 0 : -1;
    }
    for (int e = 0; e < edges; ++e) set_rates(e, 0);
    for (int e = 0; e < edges; ++e) announce(e);
  }

  void advance_to(double time) {
    while (!events_.empty() && events_.top().time <= time) {
      const Event event = events_.top();
      events_.pop();
      if (moving_[event.edge].alive && moving_[event.edge].version == event.version)
        vanish(event.edge, event.time);
    }
  }

  Front front(double time) const {
    Front front;
    for (int e = 0; e < static_cast<int>(moving_.size()); ++e) {
      const Moving& m = moving_[e];
      if (!m.alive) continue;
      const double from = m.from_at(time);
      front.push_back({edge_element(e), from, std::max(from, m.to_at(time))});
    }
    return front;
  }

 private:
  // How far beyond their corner two edges' parallels meet, per unit of distance: tan of half the turn away
  // from this side.
  double reach(int before, int after) const {
    const double turn = turn_away(side_.edges[before].along, side_.edges[after].along, side_.sign);
    return std::clamp(std::tan(turn / 2), -fastest_shock, fastest);
  }

  // Rates from now on, given the present neighbours.
  void set_rates(int edge, double now) {
    Moving& m = moving_[edge];
    m.from = m.from_at(now);
    m.to = m.to_at(now);
    m.since = now;
    m.from_rate = m.before < 0 ? 0 : -reach(m.before, edge);
    m.to_rate = m.after < 0 ? 0 : reach(edge, m.after);
    ++m.version;
  }

  void announce(int edge) {
    const Moving& m = moving_[edge];
    const double rate = m.to_rate - m.from_rate;
    if (rate >= 0) return;
    events_.push({m.since + std::max(0.0, m.to - m.from) / -rate, edge, m.version});
  }

  void vanish(int edge, double now) {
    // An open front's last edge has ends that run side by side; rounding may not end it.
    if (living_ == 1) return;
    Moving& gone = moving_[edge];
    gone.alive = false;
    --living_;
    if (side_.closed && living_ <= 2) {
      for (Moving& m : moving_) m.alive = false;
      living_ = 0;
      return;
    }
    if (gone.before >= 0) moving_[gone.before].after = gone.after;
    if (gone.after >= 0) moving_[gone.after].before = gone.before;
    for (const int e : {gone.before, gone.after}) {
      if (e < 0) continue;
      set_rates(e, now);
      announce(e);
    }
  }

  const Side& side_;
  std::vector<Moving> moving_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  int living_ = 0;
};

}  // namespace

std::vector<Front> route_map_fronts(const Side& side, int layers) {
  RouteMap map(side);
  std::vector<Front> fronts;
  fronts.reserve(layers);
  for (int k = 1; k <= layers; ++k) {
    // Events within rounding of a layer come before it.
    map.advance_to(k * (1 + 1e-12));
    fronts.push_back(map.front(k));
  }
  return fronts;
}

}  // namespace sonoband::flow
