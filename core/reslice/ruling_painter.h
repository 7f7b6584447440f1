// Paints curved bundles of lines, nearest B-scan, 8 lines by 8 samples at a time, where the frames are a
// chain (core/reslice/chain.h). Along a line all is affine, so each boundary between two frames is one sample
// per line; from line to line and layer to layer nothing is.
#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "core/reslice/band_painter.h"

namespace sonoband {

constexpr int rulings_together = 8;
constexpr int rulings_in_turn = 32;  // by one thread

// One thread's painter. Blocks may come in any order.
class RulingPainter {
 public:
  RulingPainter(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                BandImage& image, const std::atomic<bool>* stop)
      : table_(table),
        bundle_(bundle),
        nearest_(settings.interpolation == Interpolation::nearest),
        rule_(rule_of(settings.compounding, table.kind)),
        image_(image),
        stop_(stop),
        totals_(rule_),
        general_(table, settings, image, stop) {}

  // Rows first .. first + rulings_in_turn - 1. `frames` are those that may matter, ascending.
  void paint(const std::vector<int>& frames, int first);

 private:
  // Samples [a, end) of the rows.
  struct Region {
    int first = 0, last = 0;
    int a = 0, end = 0;
  };
  struct alignas(64) Feet {
    std::array<FixedPx, rulings_together> x, y;
  };
  // Where along each line a condition begins to hold, or ceases to.
  struct Boundary {
    bool rising = true;
    std::vector<RulingChange> layers;
  };

  bool present(int row, int layer) const {
    return bundle_.present.empty() ||
           bundle_.present[static_cast<std::size_t>(row) * bundle_.layers + layer] != 0;
  }
  Interpolation interpolation() const { return nearest_ ? Interpolation::nearest : Interpolation::linear; }
  void find_lines(const Region& region);
  void paint_region(const Region& region, const std::vector<int>& frames);
  void paint_chain(const Region& region, const Chain& chain, const std::vector<Candidate>& candidates);
  void distances(const Region& region, const AffineScalar& z, std::vector<RuledValues>& out) const;
  Boundary boundary(const Region& region, const std::vector<RuledValues>& before,
                    const std::vector<RuledValues>* after, double per_sample, double offset) const;
  Boundary constant(bool holds) const;
  void add_layer(const Region& region, const FrameEntry& frame, const Boundary& from, const Boundary& to,
                 int layer);

  const FrameTable& table_;
  const LineBundle& bundle_;
  bool nearest_;
  Rule rule_;
  BandImage& image_;
  const std::atomic<bool>* stop_;  // may be null
  PatchTotals totals_;
  BandPainter general_;
  std::vector<std::uint8_t> lines_;  // by layer, a bit for each line that exists
  std::vector<PatchFrame> patches_;
  std::vector<Feet> feet_;
  std::vector<RulingLayer> layers_;
  std::vector<RulingCell> cells_;
};

}  // namespace sonoband
