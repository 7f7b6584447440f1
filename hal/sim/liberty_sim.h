// A LIBERTY or PATRIOT behind a byte port: its unit (liberty_unit.h) on the bus of tracker_bus.h.
#pragma once

#include <vector>

#include "hal/sim/liberty_unit.h"
#include "hal/sim/tracker_bus.h"

namespace sonoband::sim {

struct LibertySimConfig {
  LibertyUnitConfig unit;
  TrackerBusConfig bus;
  std::vector<Fault> faults;  // in any order
};

class LibertySim final : public TrackerBus {
 public:
  LibertySim(Clock& clock, const LibertySimConfig& config, const ProbePose& pose)
      : TrackerBus(clock, TrackerFamily::liberty, config.bus, config.faults, config.unit.seed,
                   [&](TrackerUnit::Sink sink, Stamp now) {
                     return std::make_unique<LibertyUnit>(config.unit, pose, std::move(sink), now);
                   }) {}
};

}  // namespace sonoband::sim
