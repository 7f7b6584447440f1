// The rig of the tracker's fault tests: a LIBERTY on a bus without bursts that has the faults it is given.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/hal/tracker/tracker_rig.h"

namespace sonoband::test {

inline sim::LibertySimConfig with(std::vector<sim::Fault> faults, int sensors = 1) {
  sim::LibertySimConfig config;
  config.unit.sensors = sensors;
  config.bus.bursts_per_minute = 0;
  config.faults = std::move(faults);
  return config;
}

// A second after the fault at 3 s the stream is whole again.
inline void expect_streams_after(Rig& rig, double until = 5) {
  rig.run(until - (seconds(rig.clock.now()) - 1000));
  EXPECT_EQ(rig.state(), DeviceState::running);
  ASSERT_FALSE(rig.samples.empty());
  EXPECT_EQ(rig.samples.back().quality, PoseQuality::good);
  EXPECT_LT(rig.clock.now() - rig.samples.back().time, from_seconds(0.02));
}

}  // namespace sonoband::test
