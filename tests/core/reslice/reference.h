// The definition of core/reslice/band.h, carried out for every sample over every frame in double precision:
// the judge of every kernel. Slow on purpose, and written apart from the kernels.
#pragma once

#include <set>
#include <utility>

#include "core/reslice/band.h"

namespace sonoband::test {

BandImage reference_lines(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings);
BandImage reference_planar(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings);

// What a kernel may give for each pixel when every foot may err by `px` and every distance by `mm` (nearest
// only): the smallest and greatest compounded value and coverage. A value outside is wrong, not tied.
struct TieRange {
  ImageBuffer<std::uint8_t> lowest, highest;
  ImageBuffer<std::uint16_t> least_coverage, most_coverage;
};
TieRange reference_ties(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings,
                        double px, double mm);
// Pixels of a picture that no tie explains, a foot erring by at most 1e-4 pixel and a distance by 1e-4 mm.
int beyond_ties(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings,
                const BandImage& image);
int beyond_ties(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                const BandImage& image);

// Of a mean, every (value, coverage) that pixel (x, row) may then have: means of Doppler keys have no order
// that a range could be of.
std::set<std::pair<int, int>> reference_tied_means(const SweepView& sweep, const LineBundle& bundle,
                                                   const GapLimit& gap, int x, int row, double px, double mm);

}  // namespace sonoband::test
