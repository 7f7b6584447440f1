#include "core/reslice/patch_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reslice/tile.h"

namespace sonoband {
namespace {

// Of one patch, frame and layer, in instructions or so; of a pixel to be turned.
struct FetchCosts {
  double rows, row;  // of few pixel rows: in all, and of each
  double window;
  double single;
  double window_px;  // greatest span of lanes that fits
  double turned_pixel;
  double edge;  // by how much a patch in which pictures end costs more, as a part of one of a chain
};
constexpr double chain_edge = 1;  // the same where the tile is a chain
constexpr FetchCosts nearest_costs{12, 5, 22, 150, 13.5, 1, 2};
constexpr FetchCosts linear_costs{70, 12, 90, 800, 12.5, 1, 5};

// What a frame's foot and distance move by.
struct TileSteps {
  double x_per_sample, x_per_row, y_per_sample, y_per_row, z_per_sample, z_per_row;
};

// By how much feet and distance vary over a patch's lanes; how many more patches a tile takes.
struct ShapeSpan {
  double columns, rows, mm, waste;

  ShapeSpan(int width, int height, const TileSteps& steps)
      : columns(std::abs(steps.x_per_sample) * width + std::abs(steps.x_per_row) * height),
        rows(std::abs(steps.y_per_sample) * width + std::abs(steps.y_per_row) * height),
        mm(std::abs(steps.z_per_sample) * width + std::abs(steps.z_per_row) * height),
        waste(1) {}
  ShapeSpan(LaneShape shape, const LatticeBlock& tile, const TileSteps& steps) {
    const double w = shape.across - 1, h = shape.down() - 1;
    const auto span = [&](double per_sample, double per_row) {
      if (shape.rows_per_sample != 0) {
        return std::abs(per_sample + shape.rows_per_sample * per_row) * w + std::abs(per_row) * (h + 1);
      }
      if (shape.samples_per_row != 0) {
        return std::abs(per_row + shape.samples_per_row * per_sample) * h + std::abs(per_sample) * (w + 1);
      }
      return std::abs(per_sample) * w + std::abs(per_row) * h;
    };
    columns = span(steps.x_per_sample, steps.x_per_row);
    rows = span(steps.y_per_sample, steps.y_per_row);
    mm = span(steps.z_per_sample, steps.z_per_row);
    const auto more = [](double shift, int side, int of) { return std::ceil(shift / side) * side / of; };
    const auto whole = [](int of, int side) { return std::ceil(of / static_cast<double>(side)) * side / of; };
    waste = whole(tile.width, shape.across) * whole(tile.height, shape.down()) +
            more(std::abs(shape.rows_per_sample) * w, shape.down(), tile.height) +
            more(std::abs(shape.samples_per_row) * h, shape.across, tile.width);
  }
};

// Which edges of pictures, or of the mask, run through a tile.
struct Edges {
  bool sides = false, ends = false;  // of pixel rows; of pixel columns

  explicit Edges(const Tile& tile) {
    if (tile.is_chain && tile.chain.whole) return;
    for (const Candidate& c : tile.candidates) {
      if (c.full) continue;
      const FrameEntry& f = tile.table->frames[c.frame];
      const auto ends_within = [&](const AffineScalar& axis, int size) {
        const Span feet = span_of(axis, tile.box);
        return feet.lowest < -0.5 || feet.highest > size - 0.5;
      };
      sides = sides || ends_within(f.x_px, f.width);
      ends = ends || ends_within(f.y_px, f.height);
    }
    // The mask's may run any way.
    if (!sides && !ends) sides = ends = true;
  }
};

// The part of a tile's patches that an edge runs through: `patch` and `tile` span so many pixels across it in
// a layer, and `depth` more over all of them.
double part_at_edge(double patch, double tile, double depth) {
  return std::min(1.0, (patch + depth + 1) / (tile + depth + 1));
}

// A rectangle, and such sheared along the frames' traces.
template <class Try>
void try_shapes(int across, bool may_shear, const TileSteps& steps, Try&& try_shape) {
  // Steeper ones waste more than they save.
  constexpr double steepest = 2;
  try_shape(LaneShape{across});
  if (!may_shear) return;
  const double za = steps.z_per_sample, zb = steps.z_per_row;
  if (across > 1 && std::abs(za) < steepest * std::abs(zb)) try_shape(LaneShape{across, 0, -za / zb});
  if (across < patch_lanes && std::abs(zb) < steepest * std::abs(za))
    try_shape(LaneShape{across, -zb / za, 0});
}

}  // namespace

PatchChoice choose_patches(const Tile& tile, const Lattice& lattice, Interpolation interpolation,
                           const PatchFreedom& may) {
  const std::vector<Candidate>& candidates = tile.candidates;
  const LatticeBlock& block = tile.block;
  const Candidate& middle = *std::min_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return std::abs(a.z_centre) < std::abs(b.z_centre); });
  const FrameEntry& f = tile.table->frames[middle.frame];
  const auto per = [&](const AffineScalar& g, const Eigen::Vector3d& step) { return g.gradient.dot(step); };
  const TileSteps steps{per(f.x_px, lattice.per_sample), per(f.x_px, lattice.per_row),
                        per(f.y_px, lattice.per_sample), per(f.y_px, lattice.per_row),
                        per(f.z_mm, lattice.per_sample), per(f.z_mm, lattice.per_row)};
  const double xl = std::abs(per(f.x_px, lattice.per_layer)), yl = std::abs(per(f.y_px, lattice.per_layer));
  double spacing = std::max(2 * f.gap_mm, 1e-3);
  if (const Chain& chain = tile.chain; tile.is_chain && chain.members.size() > 1) {
    const double mm = candidates[chain.members.front()].z_centre - candidates[chain.members.back()].z_centre;
    spacing = std::max(mm / static_cast<double>(chain.members.size() - 1), 1e-3);
  }
  const double frames_per_layer = std::abs(per(f.z_mm, lattice.per_layer)) / spacing;
  const FetchCosts& costs = interpolation == Interpolation::linear ? linear_costs : nearest_costs;
  const Edges edges(tile);
  const ShapeSpan whole(block.width, block.height, steps);
  const auto at_edges = [&](const ShapeSpan& span) {
    double part = 0;
    if (edges.sides) part += part_at_edge(span.columns, whole.columns, xl * block.depth);
    if (edges.ends) part += part_at_edge(span.rows, whole.rows, yl * block.depth);
    return std::min(part, 1.0);
  };
  const double patches = std::max(1.0, static_cast<double>(block.width) * block.height / patch_lanes);
  const double turning = costs.turned_pixel * may.turned_pixels / (patches * block.depth);
  const double edge = tile.is_chain ? chain_edge : costs.edge;
  PatchChoice best;
  double least = 1e30;
  const auto consider = [&](const LaneShape& tried, bool turned) {
    ShapeSpan span(tried, block, steps);
    const double along = turned ? yl : xl, across = turned ? xl : yl;
    if (turned) std::swap(span.columns, span.rows);
    double cost = costs.single;
    if (span.columns < 125 && span.rows < 24) cost = costs.rows + costs.row * (span.rows + 1);
    if (span.columns < costs.window_px && span.rows < costs.window_px) {
      const double room = costs.window_px + 1;
      const double reloads =
          std::max({along / (room - span.columns), across / (room - span.rows), frames_per_layer});
      cost = std::min(cost, costs.window + 30 * std::min(1.0, reloads));
    }
    // Lane by lane the tables of sheared lanes might not hold.
    if (cost == costs.single && (tried.sheared() || turned)) return;
    cost *= (1 + span.mm / spacing) * span.waste * (1 + edge * at_edges(span));
    // A shear must be worth its ragged edges.
    if (tried.sheared()) cost *= 1.15;
    // As must be a second copy in the caches.
    if (turned) cost = 1.25 * cost + turning;
    if (cost >= least) return;
    least = cost;
    best = {tried, turned};
  };
  for (int across = patch_lanes; across >= 1; across /= 2) {
    try_shapes(across, may.shear, steps, [&](const LaneShape& tried) {
      consider(tried, false);
      if (may.turn) consider(tried, true);
    });
  }
  return best;
}

}  // namespace sonoband
