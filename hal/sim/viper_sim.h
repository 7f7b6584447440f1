// A VIPER behind a byte port: its unit (viper_unit.h) on the bus of tracker_bus.h.
#pragma once

#include <vector>

#include "hal/sim/tracker_bus.h"
#include "hal/sim/viper_unit.h"

namespace sonoband::sim {

struct ViperSimConfig {
  ViperUnitConfig unit;
  TrackerBusConfig bus;
  std::vector<Fault> faults;  // in any order
};

class ViperSim final : public TrackerBus {
 public:
  ViperSim(Clock& clock, const ViperSimConfig& config, const ProbePose& pose)
      : TrackerBus(clock, TrackerFamily::viper, config.bus, config.faults, config.unit.seed,
                   [&](TrackerUnit::Sink sink, Stamp now) {
                     return std::make_unique<ViperUnit>(config.unit, pose, std::move(sink), now);
                   }) {}
};

}  // namespace sonoband::sim
