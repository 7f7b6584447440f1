#include "core/reslice/tile.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonoband {
namespace {

FixedPx fixed(double px) {
  return std::llround(px * fixed_per_px);
}

// Of one frame and layer, in instructions or so.
struct FetchCosts {
  double rows, row;  // of few pixel rows: in all, and of each
  double window;
  double single;
  double window_px;  // greatest span of lanes that fits
  double edge;       // by how much a patch in which pictures end costs more, as a part of one of a chain
};
constexpr FetchCosts nearest_costs{12, 5, 22, 150, 13.5, 2};
constexpr FetchCosts linear_costs{70, 12, 90, 800, 12.5, 5};

// Asks for the pixels the tile will take from a frame: the memory's answers overlap, where the kernels' would
// come one by one.
void prefetch(const FrameTable& table, const Lattice& lattice, const LatticeBlock& tile, const TileFrame& t,
              const Candidate& candidate) {
  const FrameEntry& f = table.frames[candidate.frame];
  // The range of each axis in which the frame is within reach at all.
  const AffineScalar z = oriented_z(f);
  const double reach = f.gap_mm;
  const std::array<double, 3> per = {z.gradient.dot(lattice.per_sample), z.gradient.dot(lattice.per_row),
                                     z.gradient.dot(lattice.per_layer)};
  const std::array<int, 3> size = {tile.width - 1, tile.height - 1, tile.depth - 1};
  const double half_range = (candidate.z.highest - candidate.z.lowest) / 2;
  std::array<double, 3> low{}, high{};
  for (int i = 0; i < 3; ++i) {
    low[i] = 0;
    high[i] = size[i];
    if (std::abs(per[i]) < 1e-6) continue;
    const double others = half_range - std::abs(per[i]) * size[i] / 2 + reach;
    const double centre = size[i] / 2.0 - candidate.z_centre / per[i], width = others / std::abs(per[i]);
    low[i] = std::clamp(centre - width, 0.0, static_cast<double>(size[i]));
    high[i] = std::clamp(centre + width, low[i], static_cast<double>(size[i]));
  }
  const auto range = [&](FixedPx at, FixedPx a, FixedPx b, FixedPx l) {
    const std::array<FixedPx, 3> steps = {a, b, l};
    double least = static_cast<double>(at), greatest = least;
    for (int i = 0; i < 3; ++i) {
      const double from = static_cast<double>(steps[i]) * low[i],
                   to = static_cast<double>(steps[i]) * high[i];
      least += std::min(from, to);
      greatest += std::max(from, to);
    }
    return std::pair(least / fixed_per_px, greatest / fixed_per_px);
  };
  const auto [left, right] = range(t.at.x, t.at.x_per_sample, t.at.x_per_row, t.at.x_per_layer);
  const auto [top, bottom] = range(t.at.y, t.at.y_per_sample, t.at.y_per_row, t.at.y_per_layer);
  const int x0 = static_cast<int>(std::clamp(left, 0.0, f.width - 1.0));
  const int x1 = static_cast<int>(std::clamp(right, 0.0, f.width - 1.0));
  const int y0 = static_cast<int>(std::clamp(top, 0.0, f.height - 1.0));
  const int y1 = static_cast<int>(std::clamp(bottom, 0.0, f.height - 1.0));
  for (int y = y0; y <= y1; ++y) {
    const std::uint8_t* row = f.pixels + y * f.stride;
    for (int x = x0; x < x1 + 64; x += 64) __builtin_prefetch(row + std::min(x, x1), 0, 2);
  }
}

}  // namespace

LaneMask existing_lanes(LaneShape shape, int width, int height) {
  if (width >= shape.across && height >= shape.down()) return ~LaneMask{0};
  LaneMask lanes = 0;
  for (int k = 0; k < patch_lanes; ++k)
    if (k % shape.across < width && k / shape.across < height) lanes |= LaneMask{1} << k;
  return lanes;
}

LaneMask existing_lanes(const LaneGrid& grid, int a, int b, int width, int height) {
  if (a + grid.least_a >= 0 && a + grid.greatest_a < width && b + grid.least_b >= 0 &&
      b + grid.greatest_b < height)
    return ~LaneMask{0};
  LaneMask lanes = 0;
  for (int i = 0; i < grid.run_count; ++i) {
    const LaneRun& run = grid.runs[i];
    if (b + run.b < 0 || b + run.b >= height) continue;
    const int first = std::max(0, -(a + run.a)), last = std::min(run.count, width - (a + run.a));
    if (first < last) lanes |= ~LaneMask{0} >> (patch_lanes - (last - first)) << (run.lane + first);
  }
  return lanes;
}

namespace {

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
  ShapeSpan(LaneShape shape, const TileSteps& steps) {
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
    const auto more = [](double shift, int side) { return std::ceil(shift / side) * side / tile_pixels; };
    waste = 1 + more(std::abs(shape.rows_per_sample) * w, shape.down()) +
            more(std::abs(shape.samples_per_row) * h, shape.across);
  }
};

// Which edges of pictures, or of the mask, run through a tile that is no chain.
struct Edges {
  bool sides = false, ends = false;  // of pixel rows; of pixel columns

  explicit Edges(const Tile& tile) {
    if (tile.is_chain) return;
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

LaneShape Tile::choose_shape(const Lattice& lattice, Interpolation interpolation, bool may_shear) const {
  const Candidate& middle = *std::min_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return std::abs(a.z_centre) < std::abs(b.z_centre); });
  const FrameEntry& f = table->frames[middle.frame];
  const auto per = [&](const AffineScalar& g, const Eigen::Vector3d& step) { return g.gradient.dot(step); };
  const TileSteps steps{per(f.x_px, lattice.per_sample), per(f.x_px, lattice.per_row),
                        per(f.y_px, lattice.per_sample), per(f.y_px, lattice.per_row),
                        per(f.z_mm, lattice.per_sample), per(f.z_mm, lattice.per_row)};
  const double xl = std::abs(per(f.x_px, lattice.per_layer)), yl = std::abs(per(f.y_px, lattice.per_layer));
  double spacing = std::max(2 * f.gap_mm, 1e-3);
  if (is_chain && chain.members.size() > 1) {
    const double mm = candidates[chain.members.front()].z_centre - candidates[chain.members.back()].z_centre;
    spacing = std::max(mm / static_cast<double>(chain.members.size() - 1), 1e-3);
  }
  const double frames_per_layer = std::abs(per(f.z_mm, lattice.per_layer)) / spacing;
  const FetchCosts& costs = interpolation == Interpolation::linear ? linear_costs : nearest_costs;
  const Edges edges(*this);
  const ShapeSpan whole(block.width, block.height, steps);
  const auto at_edges = [&](const ShapeSpan& span) {
    double part = 0;
    if (edges.sides) part += part_at_edge(span.columns, whole.columns, xl * block.depth);
    if (edges.ends) part += part_at_edge(span.rows, whole.rows, yl * block.depth);
    return std::min(part, 1.0);
  };
  LaneShape best;
  double least = 1e30;
  for (int across = patch_lanes; across >= 1; across /= 2) {
    try_shapes(across, may_shear, steps, [&](const LaneShape& tried) {
      const ShapeSpan span(tried, steps);
      double cost = costs.single;
      if (span.columns < 125 && span.rows < 24) cost = costs.rows + costs.row * (span.rows + 1);
      if (span.columns < costs.window_px && span.rows < costs.window_px) {
        const double room = costs.window_px + 1;
        const double reloads =
            std::max({xl / (room - span.columns), yl / (room - span.rows), frames_per_layer});
        cost = std::min(cost, costs.window + 30 * std::min(1.0, reloads));
      }
      // Lane by lane the tables of sheared lanes might not hold.
      if (cost == costs.single && tried.sheared()) return;
      cost *= (1 + span.mm / spacing) * span.waste * (1 + costs.edge * at_edges(span));
      // A shear must be worth its ragged edges.
      if (tried.sheared()) cost *= 1.15;
      if (cost >= least) return;
      least = cost;
      best = tried;
    });
  }
  return best;
}

void Tile::make_frames(const Lattice& lattice, int a, int b, int taps) {
  if (frames.size() < candidates.size()) frames.resize(candidates.size());
  const Eigen::Vector3d origin = lattice.at(a, b, 0);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const FrameEntry& f = table->frames[candidates[c].frame];
    TileFrame& t = frames[c];
    const FootSteps steps{f.x_px.gradient.dot(lattice.per_sample), f.x_px.gradient.dot(lattice.per_row),
                          f.y_px.gradient.dot(lattice.per_sample), f.y_px.gradient.dot(lattice.per_row)};
    make_patch_frame(f, steps, grid, taps, t.patch);
    t.at.x = fixed_position(f.x_px.at(origin));
    t.at.y = fixed_position(f.y_px.at(origin));
    t.at.x_per_sample = fixed(steps.x_per_sample);
    t.at.x_per_row = fixed(steps.x_per_row);
    t.at.x_per_layer = fixed(f.x_px.gradient.dot(lattice.per_layer));
    t.at.y_per_sample = fixed(steps.y_per_sample);
    t.at.y_per_row = fixed(steps.y_per_row);
    t.at.y_per_layer = fixed(f.y_px.gradient.dot(lattice.per_layer));
  }
}

int Tile::index_of(int frame) const {
  const auto found = std::lower_bound(candidates.begin(), candidates.end(), frame,
                                      [](const Candidate& c, int f) { return c.frame < f; });
  return static_cast<int>(found - candidates.begin());
}

void Tile::keep_chain_only() {
  std::vector<int> members = chain.members;
  std::sort(members.begin(), members.end());
  const auto place = [&](int m) {
    return static_cast<int>(std::lower_bound(members.begin(), members.end(), m) - members.begin());
  };
  for (std::size_t i = 0; i < members.size(); ++i) candidates[i] = candidates[members[i]];
  candidates.resize(members.size());
  for (int& m : chain.members) m = place(m);
}

bool Tile::find(const FrameTable& frame_table, const Lattice& lattice, const std::vector<int>& near,
                Interpolation interpolation, int a, int b) {
  table = &frame_table;
  block = {a,
           b,
           0,
           std::min(tile_pixels, lattice.samples - a),
           std::min(tile_pixels, lattice.rows - b),
           lattice.layers};
  box = box_of(block);
  cull(frame_table, near, box, interpolation, candidates);
  is_chain = make_chain(frame_table, candidates, box, chain);
  return !candidates.empty();
}

void Tile::thin(Interpolation interpolation, double thin_mm, LeftOut& count) {
  thin_chain(*table, candidates, box, thin_mm, interpolation, chain);
  count.add(candidates.size(), chain.members.size());
  keep_chain_only();
}

void Tile::open(const Lattice& lattice, Interpolation interpolation, bool may_shear) {
  shape = choose_shape(lattice, interpolation, may_shear && is_chain);
  grid = lane_grid(shape);
  make_frames(lattice, block.a, block.b, interpolation == Interpolation::linear ? 2 : 1);
  for (std::size_t c = 0; c < candidates.size(); ++c)
    prefetch(*table, lattice, block, frames[c], candidates[c]);
}

}  // namespace sonoband
