#include "core/reslice/chain_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/reslice/patch_kernels.h"
#include "core/reslice/ties.h"

namespace sonoband {
namespace {

// Room for the rounding of 32-bit floats; ties go the written way.
constexpr double float_tie_mm = 1e-5;
// ChainShare::even asks for gaps that vary by at most so much of their middle: the series in the kernels then
// errs by 0.15^4, an eighth of a level between black and white.
constexpr double most_bend = 0.15;
// And that are no narrower: a sample's distance, a 32-bit float, may put it so far beyond its cell.
constexpr double least_even_gap_mm = 0.005;
// And that the tile's samples are within so many gaps: shares in 1/2^32 of a kernel's unit then have 63 bits.
constexpr double most_gaps_away = 30000;

AffineScalar plus(AffineScalar f, double offset) {
  f.offset += offset;
  return f;
}

AffineScalar less(const AffineScalar& a, const AffineScalar& b) {
  return {a.gradient - b.gradient, a.offset - b.offset};
}

// Lays out what is affine over a tile, from its corner and layer `l`.
struct TileLayout {
  const Lattice& lattice;
  const Tile& tile;
  int l = 0;

  Eigen::Vector3d origin() const { return lattice.at(tile.block.a, tile.block.b, l); }

  ChainBoundary boundary(const AffineScalar& value) const {
    const double per_layer = value.gradient.dot(lattice.per_layer);
    ChainBoundary result;
    result.rising = per_layer >= 0;
    // A condition that hardly changes from layer to layer changes beyond the last one.
    const double inverse = (result.rising ? -1 : 1) / std::max(std::abs(per_layer), 1e-20);
    result.first = static_cast<float>(value.at(origin()) * inverse);
    result.per_sample = static_cast<float>(value.gradient.dot(lattice.per_sample) * inverse);
    result.per_row = static_cast<float>(value.gradient.dot(lattice.per_row) * inverse);
    patch_kernels().lay_lanes(tile.grid, result);
    return result;
  }

  TileDistance distance(const AffineScalar& mm) const {
    return {static_cast<float>(mm.at(origin())), static_cast<float>(mm.gradient.dot(lattice.per_sample)),
            static_cast<float>(mm.gradient.dot(lattice.per_row)),
            static_cast<float>(mm.gradient.dot(lattice.per_layer))};
  }

  // Of value / unit; the kernels cut off, so half a unit more.
  TileFixed fixed(const AffineScalar& value, double unit) const {
    const auto units = [&](double v) { return std::llround(v / unit * fixed_per_px); };
    return {units(value.at(origin()) + unit / 2), units(value.gradient.dot(lattice.per_sample)),
            units(value.gradient.dot(lattice.per_row)), units(value.gradient.dot(lattice.per_layer))};
  }

  // Between frames at z and z - gap.
  void share(const AffineScalar& z, const AffineScalar& gap, const SampleBox& box, ChainShare& out) const {
    const Span mm = span_of(gap, box);
    const double middle = (mm.highest + mm.lowest) / 2, bend = (mm.highest - mm.lowest) / 2;
    const auto near = [&](const AffineScalar& f) {
      const Span over_tile = span_of(f, tile.box);
      return std::max(-over_tile.lowest, over_tile.highest) <= most_gaps_away * middle;
    };
    out.even = mm.lowest >= least_even_gap_mm && bend <= most_bend * middle && near(z) && near(gap);
    if (out.even) {
      out.part = fixed(z, middle / share_full);
      out.bend = fixed(plus(gap, -middle), middle / bend_full);
    } else {
      out.z = distance(z);
      out.gap = distance(gap);
    }
    patch_kernels().lay_share(tile.grid, out);
  }
};

void lay_out_frames(const Tile& tile, const Chain& chain, const std::vector<Candidate>& candidates, int l,
                    ChainCells& cells) {
  for (const int m : chain.members) {
    const int place = tile.index_of(candidates[m].frame);
    const TileFrame& t = tile.frames[place];
    cells.members.push_back(place);
    ChainFrame frame = t.at;
    frame.frame = &t.patch;
    frame.x += l * frame.x_per_layer;
    frame.y += l * frame.y_per_layer;
    cells.frames.push_back(frame);
  }
}

}  // namespace

bool all_taps_kept(const FrameTable& table, const FrameEntry& frame, const SampleBox& box) {
  if (table.mask_sums.empty()) return true;
  constexpr double room = 1e-3;  // px, beyond rounding
  const auto taps = [&](const AffineScalar& axis, int size) {
    const Span feet = span_of(axis, box);
    const auto pixel = [&](double at) {
      return static_cast<int>(std::clamp(std::floor(at), 0.0, size - 1.0));
    };
    return std::pair(pixel(feet.lowest - room), pixel(feet.highest + room + 1));
  };
  const auto [left, right] = taps(frame.x_px, frame.width);
  const auto [top, bottom] = taps(frame.y_px, frame.height);
  return table.mask_sums.kept(left, top, right, bottom) ==
         static_cast<std::uint32_t>(right - left + 1) * static_cast<std::uint32_t>(bottom - top + 1);
}

void lay_out(const Lattice& lattice, const Tile& tile, const Chain& chain,
             const std::vector<Candidate>& candidates, const SampleBox& box, int l,
             Interpolation interpolation, ChainCells& cells) {
  const FrameTable& table = *tile.table;
  const bool linear = interpolation == Interpolation::linear;
  cells.members.clear();
  cells.frames.clear();
  cells.distances.clear();
  cells.reaches.clear();
  cells.by_capture.clear();
  cells.shares.clear();
  cells.boundaries.clear();
  cells.grey_taps = linear && table.kind == PixelKind::grey;
  lay_out_frames(tile, chain, candidates, l, cells);
  const TileLayout layout{lattice, tile, l};
  const std::size_t members = chain.members.size();
  const auto entry = [&](std::size_t m) -> const FrameEntry& {
    return table.frames[candidates[chain.members[m]].frame];
  };
  const auto z = [&](std::size_t m) { return oriented_z(entry(m)); };
  const auto reach = [&](std::size_t m) { return entry(m).gap_mm + tie_mm + float_tie_mm; };
  for (std::size_t m = 0; m < members; ++m)
    cells.grey_taps = cells.grey_taps && all_taps_kept(table, entry(m), box);
  cells.unblended = cells.grey_taps && chain.unblended;
  const bool blended = linear && !cells.unblended;
  ChainBoundary always, never;
  always.always = true;
  never.never = true;
  // First begins where the first frame reaches, z >= -d; the last ends where z > d.
  cells.boundaries.push_back(chain.first_ends ? layout.boundary(plus(z(0), reach(0))) : always);
  for (std::size_t m = 0; m < members; ++m) {
    const AffineScalar mm = z(m);
    if (blended) {
      cells.boundaries.push_back(layout.boundary(mm));
      cells.distances.push_back(layout.distance(mm));
      if (m > 0) layout.share(z(m - 1), less(z(m - 1), mm), box, cells.shares.emplace_back());
      continue;
    }
    if (!chain.whole) {
      cells.distances.push_back(layout.distance(mm));
      cells.reaches.push_back(static_cast<float>(reach(m)));
    }
    if (m > 0) {
      const AffineScalar before = z(m - 1);
      const bool later = cells.members[m] > cells.members[m - 1];
      cells.boundaries.push_back(
          layout.boundary({before.gradient + mm.gradient,
                           before.offset + mm.offset + (later ? float_tie_mm : -float_tie_mm)}));
    }
  }
  if (!cells.reaches.empty()) {
    cells.by_capture.resize(members);
    std::iota(cells.by_capture.begin(), cells.by_capture.end(), 0);
    std::sort(cells.by_capture.begin(), cells.by_capture.end(),
              [&](int a, int b) { return cells.members[a] < cells.members[b]; });
  }
  cells.boundaries.push_back(chain.last_ends ? layout.boundary(plus(z(members - 1), -reach(members - 1)))
                                             : never);
}

}  // namespace sonoband
