// A pedal on made-up contacts.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "hal/footswitch/contact_footswitch.h"
#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband::test::pedal {

// What a test and the source it gave away both see.
struct Wires {
  struct Event {
    double t_s;
    int contact;
    bool active;
    std::uint32_t sequence = 0;
    ContactStatus status = ContactStatus::ok;
  };
  std::deque<Event> events;
  std::vector<bool> levels{false, true};
  ContactStatus opening = ContactStatus::ok;
  bool dead = false;
  std::int64_t stamp_shift_ns = 0;
  int opens = 0;
  bool is_open = false;
  std::vector<ContactRequest> asked;
};

class FakeContacts final : public ContactSource {
 public:
  FakeContacts(Wires& wires, Clock& clock) : wires_(wires), clock_(clock) {}
  ContactStatus open(std::span<const ContactRequest> contacts) override {
    ++wires_.opens;
    wires_.asked.assign(contacts.begin(), contacts.end());
    wires_.is_open = wires_.opening == ContactStatus::ok;
    return wires_.opening;
  }
  ContactStatus wait(ContactEdge& out, Duration timeout) override {
    const Stamp until = clock_.now() + timeout;
    if (wires_.events.empty() || at(wires_.events.front().t_s) > until) {
      clock_.sleep_until(until);
      return ContactStatus::nothing_yet;
    }
    const Wires::Event e = wires_.events.front();
    wires_.events.pop_front();
    clock_.sleep_until(at(e.t_s) + std::chrono::microseconds(200));
    if (e.status != ContactStatus::ok) return e.status;
    wires_.levels[static_cast<std::size_t>(e.contact)] = e.active;
    out = {e.contact, e.active, at(e.t_s).time_since_epoch().count() + wires_.stamp_shift_ns, e.sequence};
    return ContactStatus::ok;
  }
  std::optional<bool> level(int contact) override {
    if (wires_.dead) return std::nullopt;
    return wires_.levels[static_cast<std::size_t>(contact)];
  }
  void close() override { wires_.is_open = false; }

 private:
  Wires& wires_;
  Clock& clock_;
};

struct Rig {
  explicit Rig(bool pair = false) {
    PedalWiring pedal{.closes = {.name = "FOOTSWITCH_NO", .active_low = true, .bias = Bias::pull_up},
                      .opens = {}};
    if (pair) pedal.opens = ContactRequest{.name = "FOOTSWITCH_NC"};
    footswitch = std::make_unique<ContactFootswitch>(std::make_unique<FakeContacts>(wires, clock), clock,
                                                     std::vector<PedalWiring>{pedal});
    footswitch->start();
  }
  void run_to(double s) {
    PedalEdge e;
    while (clock.now() < at(s))
      if (footswitch->read(e, std::min<Duration>(std::chrono::milliseconds(20), at(s) - clock.now())) ==
          ReadStatus::ok)
        edges.push_back(e);
  }
  DeviceHealth health() const { return footswitch->health(); }

  test::SteppedClock clock;
  Wires wires;
  std::unique_ptr<ContactFootswitch> footswitch;
  std::vector<PedalEdge> edges;
};

}  // namespace sonoband::test::pedal
