// A pedal that bounces: scripted, or pressed live from another thread.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "hal/clock.h"
#include "hal/devices.h"
#include "hal/shared_health.h"

namespace sonoband::sim {

struct PedalPress {
  Duration press;  // from the origin
  Duration release;
};

struct PedalFault {
  enum class Kind : std::uint8_t {
    lose_edges,  // the kernel's queue overflows: edges vanish and their numbers with them
    unplug,
  } kind = Kind::lose_edges;
  Duration from{};  // from the origin
  Duration until{};
};

struct FootswitchSettings {
  std::vector<PedalPress> script = {};
  std::vector<PedalFault> faults = {};
  std::optional<Stamp> origin = {};  // what script and faults count from; empty: start()
  bool held_at_start = false;
  int bounces = 5;                                      // at most, of each change
  Duration bounce_time = std::chrono::milliseconds(6);  // they are over after this
  std::uint64_t seed = 1;
  std::function<void(Stamp)> on_live_press = {};  // called within press()
};

class SimFootswitch final : public Footswitch {
 public:
  SimFootswitch(Clock& clock, const FootswitchSettings& settings);

  void start() override;
  ReadStatus read(PedalEdge& out, Duration timeout) override;
  DeviceHealth health() const override;
  void stop() override;

  // Live, by one thread beside the reader's; no lock. False: 64 changes are waiting already.
  bool press();
  bool release();

 private:
  struct Change {
    Stamp time;
    bool closed;
  };
  // What the contact does, bounces included, in order of time; what is before `next` is over.
  struct Course {
    std::vector<Change> changes;
    std::size_t next = 0;
  };
  bool inject(bool closed);
  void take_live();
  void add_bouncing(Course& to, Stamp time, bool closed);
  const Change* next_change() const;
  void step_over();
  const PedalFault* fault_at(Stamp t) const;
  ReadStatus deliver(PedalEdge& out, Stamp time, bool closed);

  Clock& clock_;
  FootswitchSettings settings_;
  Stamp origin_{};
  Course script_;
  Course live_;
  std::uint64_t drawn_ = 0;  // random numbers so far
  bool contact_ = false;
  std::optional<Stamp> report_level_;  // since when the level is owed
  bool plugged_ = true;
  std::uint64_t sequence_ = 0;

  static constexpr std::size_t queue_size = 64;
  std::array<Change, queue_size> queue_{};
  std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint64_t> taken_{0};

  SharedHealth health_;
};

}  // namespace sonoband::sim
