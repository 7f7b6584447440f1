// A tracker's electronics unit without its plug: commands in, bytes out, at times of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/geometry/transforms.h"
#include "core/time.h"
#include "hal/sim/liberty_faults.h"

namespace sonoband::sim {

// Where the probe's sensor is at a time, in mm. Must be a function of time alone.
using ProbePose = std::function<Rigid<frame::Tracker, frame::Probe>(Stamp)>;

class TrackerUnit {
 public:
  // Takes what the unit sends, in the order sent; `record_station` is 0 for anything but a record.
  using Sink = std::function<void(Stamp sent, std::span<const std::uint8_t> bytes, int record_station)>;

  virtual ~TrackerUnit() = default;

  virtual void receive(std::span<const std::uint8_t> bytes, Stamp now) = 0;
  // Everything it sends up to and including `now`.
  virtual void advance(Stamp now) = 0;
  // When it next may have something to send by itself.
  virtual Stamp next_send(Stamp now) const = 0;
  // Whether records wait in the unit while the host does not read, or the newest replaces the one before.
  virtual bool buffering() const = 0;
  // Faults of the unit and of its records; those of USB are not for it.
  virtual void inject(const Fault& fault) = 0;
  virtual void power_cycle(Stamp now) = 0;  // settings and counters as at power-up, no self-test wait
  virtual void usb_reset() = 0;
};

}  // namespace sonoband::sim
