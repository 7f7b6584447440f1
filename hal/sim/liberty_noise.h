// How far a LIBERTY's readings scatter, by distance from the source: the vendor's resolution table, taken as
// one standard deviation per axis.
#pragma once

namespace sonoband::sim {

struct TrackerNoise {
  double position_mm = 0;
  double angle_deg = 0;
};

// Log-log between the table's rows (305 to 1829 mm) and beyond the last; constant below the first.
TrackerNoise liberty_noise(double distance_mm);

}  // namespace sonoband::sim
