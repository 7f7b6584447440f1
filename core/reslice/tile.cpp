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
};
constexpr FetchCosts nearest_costs{12, 5, 22, 150, 13.5};
constexpr FetchCosts linear_costs{70, 12, 90, 800, 12.5};

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

LaneShape Tile::choose_shape(const Lattice& lattice, Interpolation interpolation) const {
  const Candidate& middle = *std::min_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return std::abs(a.z_centre) < std::abs(b.z_centre); });
  const FrameEntry& f = table->frames[middle.frame];
  const auto per = [&](const AffineScalar& g, const Eigen::Vector3d& step) {
    return std::abs(g.gradient.dot(step));
  };
  const double xa = per(f.x_px, lattice.per_sample), xb = per(f.x_px, lattice.per_row);
  const double ya = per(f.y_px, lattice.per_sample), yb = per(f.y_px, lattice.per_row);
  const double za = per(f.z_mm, lattice.per_sample), zb = per(f.z_mm, lattice.per_row);
  const double xl = per(f.x_px, lattice.per_layer), yl = per(f.y_px, lattice.per_layer);
  const double spacing = std::max(2 * f.gap_mm, 1e-3);
  const double frames_per_layer = per(f.z_mm, lattice.per_layer) / spacing;
  const FetchCosts& costs = interpolation == Interpolation::linear ? linear_costs : nearest_costs;
  LaneShape best;
  double least = 1e30;
  for (int across = patch_lanes; across >= 1; across /= 2) {
    const LaneShape tried{across};
    const int w = tried.across - 1, h = tried.down() - 1;
    const double columns = xa * w + xb * h, rows = ya * w + yb * h;
    double cost = costs.single;
    if (columns < 125 && rows < 24) cost = costs.rows + costs.row * (rows + 1);
    if (columns < costs.window_px && rows < costs.window_px) {
      const double room = costs.window_px + 1;
      const double reloads = std::max({xl / (room - columns), yl / (room - rows), frames_per_layer});
      cost = std::min(cost, costs.window + 30 * std::min(1.0, reloads));
    }
    cost *= 1 + (za * w + zb * h) / spacing;
    if (cost < least) {
      least = cost;
      best = tried;
    }
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
    make_patch_frame(f, steps, grid, shape, taps, t.patch);
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

void Tile::open(const Lattice& lattice, Interpolation interpolation) {
  shape = choose_shape(lattice, interpolation);
  grid = lane_grid(shape);
  make_frames(lattice, block.a, block.b, interpolation == Interpolation::linear ? 2 : 1);
  for (std::size_t c = 0; c < candidates.size(); ++c)
    prefetch(*table, lattice, block, frames[c], candidates[c]);
}

}  // namespace sonoband
