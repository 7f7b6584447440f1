// From a bundle or a plane to a picture: the choice of kernel and the spreading over threads.
#pragma once

#include <atomic>

#include "core/reslice/frame_table.h"
#include "core/reslice/lattice.h"
#include "core/reslice/layer_block.h"

namespace sonoband {

// What lattice_of(plane_lines(plane, band)) gives, bit for bit, without the lines.
Lattice plane_lattice(const ReslicePlane& plane, const Band& band);

BandImage paint(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop);
BandImage paint(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop);

// The same with frames left out that are denser than the output's pixel_mm: on a lattice by chains of all
// frames (chain.h); tiles whose frames are no chain, and curved bundles, take those of `kept`
// (make_thinned_table).
BandImage paint_thinned(const FrameTable& table, const FrameTable& kept, double pixel_mm,
                        const Lattice& lattice, const RenderSettings& settings, Parallel& parallel,
                        const std::atomic<bool>* stop);
BandImage paint_thinned(const FrameTable& table, const FrameTable& kept, double pixel_mm,
                        const LineBundle& bundle, const RenderSettings& settings, Parallel& parallel,
                        const std::atomic<bool>* stop);

// Layers apart, some strips of the picture at a time; they may be painted in any order and on any threads.
// Borrows the table.
class LayerStrips {
 public:
  // Of `settings` the interpolation counts and whether minima are asked for.
  LayerStrips(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings);
  // How many a picture has.
  static int count(const FrameTable& table, const Lattice& lattice);
  // Strips first .. first + count - 1, the better the more. Whatever they held before is overwritten.
  void paint(int first, int count, LayerBlock& layers) const;

 private:
  const FrameTable* table_;
  Lattice lattice_;
  RenderSettings settings_;
  bool in_patches_;
  FrameTable seen_;  // from the lattice
};

}  // namespace sonoband
