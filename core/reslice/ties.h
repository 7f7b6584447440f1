// How close to a boundary counts as on it. Grids that lie half a pixel apart, and layers half-way between two
// B-scans, are common; there the last bit of a rounding must not choose the picture.
#pragma once

namespace sonoband {

constexpr double tie_px = 1e-6;  // foot positions, in B-scan pixels
constexpr double tie_mm = 1e-6;  // distances from B-scans, 1 nm

}  // namespace sonoband
