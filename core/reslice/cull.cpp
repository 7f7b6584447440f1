#include "core/reslice/cull.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/reslice/ties.h"

namespace sonoband {
namespace {

enum class Support { none, some, full };

// Of feet in picture and mask, over the whole box.
Support support(const FrameTable& table, const FrameEntry& f, const SampleBox& box, bool& borders_mask) {
  borders_mask = false;
  // A pixel's border may be taken either way by a tie: full means full with a tie's room to spare.
  constexpr double room = 1e-3;
  const Span x = span_of(f.x_px, box), y = span_of(f.y_px, box);
  if (x.highest < -0.5 - room || y.highest < -0.5 - room || x.lowest > f.width - 0.5 + room ||
      y.lowest > f.height - 0.5 + room) {
    return Support::none;
  }
  const bool inside = x.lowest > -0.5 + room && y.lowest > -0.5 + room && x.highest < f.width - 0.5 - room &&
                      y.highest < f.height - 0.5 - room;
  if (table.mask_sums.empty()) return inside ? Support::full : Support::some;
  const auto pixel = [](double at, int size) {
    return static_cast<int>(std::clamp(std::floor(at + 0.5), 0.0, size - 1.0));
  };
  const int x0 = pixel(x.lowest - room, f.width), x1 = pixel(x.highest + room, f.width);
  const int y0 = pixel(y.lowest - room, f.height), y1 = pixel(y.highest + room, f.height);
  const auto kept = static_cast<std::int64_t>(table.mask_sums.kept(x0, y0, x1, y1));
  if (kept == 0) return Support::none;
  const std::int64_t area = static_cast<std::int64_t>(x1 - x0 + 1) * (y1 - y0 + 1);
  borders_mask = kept != area;
  return inside && kept == area ? Support::full : Support::some;
}

}  // namespace

BlockBox box_of(const LineBundle& bundle, const BundleBlock& block) {
  const auto index = [&](int row, int layer) {
    return static_cast<std::size_t>(row) * bundle.layers + layer;
  };
  const auto present = [&](int row, int layer) {
    return bundle.present.empty() || bundle.present[index(row, layer)] != 0;
  };
  const auto start = [&](int row, int layer) -> const Eigen::Vector3d& {
    return bundle.starts[index(row, layer)].v;
  };
  // Axes from the lines that are there: across the layers of the row in the middle, across the rows.
  struct End {
    int row = -1, layer = -1;
  };
  End first, last, bottom, top;
  const int middle_row = (block.row_begin + block.row_end) / 2;
  for (int row = block.row_begin; row < block.row_end; ++row) {
    for (int layer = 0; layer < bundle.layers; ++layer) {
      if (!present(row, layer)) continue;
      if (first.row < 0) first = {row, layer};
      last = {row, layer};
      if (row == middle_row) {
        if (bottom.row < 0) bottom = {row, layer};
        top = {row, layer};
      }
    }
  }
  if (first.row < 0) return {};
  Eigen::Vector3d per_layer = Eigen::Vector3d::Zero(), per_row = Eigen::Vector3d::Zero();
  if (bottom.row >= 0 && top.layer > bottom.layer)
    per_layer = (start(top.row, top.layer) - start(bottom.row, bottom.layer)) / (top.layer - bottom.layer);
  if (last.row > first.row)
    per_row = (start(last.row, last.layer) - start(first.row, first.layer) -
               (last.layer - first.layer) * per_layer) /
              (last.row - first.row);
  const double row_centre = (block.row_begin + block.row_end - 1) / 2.0;
  const double layer_centre = (bundle.layers - 1) / 2.0;
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d highest = -lowest;
  for (int row = block.row_begin; row < block.row_end; ++row) {
    for (int layer = 0; layer < bundle.layers; ++layer) {
      if (!present(row, layer)) continue;
      const Eigen::Vector3d rest =
          start(row, layer) - (row - row_centre) * per_row - (layer - layer_centre) * per_layer;
      lowest = lowest.cwiseMin(rest);
      highest = highest.cwiseMax(rest);
    }
  }
  const Eigen::Vector3d rest = (highest - lowest) / 2;
  BlockBox result;
  result.empty = false;
  result.box.centre =
      (lowest + highest) / 2 + (block.sample_begin + block.sample_end - 1) / 2.0 * bundle.step.v;
  result.box.along = rest;
  result.box.slanted = true;
  result.box.half = {(block.sample_end - 1 - block.sample_begin) / 2.0 * bundle.step.v,
                     (block.row_end - 1 - block.row_begin) / 2.0 * per_row, layer_centre * per_layer};
  return result;
}

void cull(const FrameTable& table, const std::vector<int>& frames, const SampleBox& box,
          Interpolation interpolation, std::vector<Candidate>& kept) {
  const double reach = interpolation == Interpolation::linear ? 2 : 1;
  kept.clear();
  int above = -1, below = -1;  // of `kept`: nearest server of the whole box on either side
  for (const int i : frames) {
    const FrameEntry& f = table.frames[i];
    Candidate c;
    c.frame = i;
    c.z_centre = f.z_mm.at(box.centre);
    const double extent = box.extent(f.z_mm.gradient);
    if (std::abs(c.z_centre) - extent > reach * f.gap_mm + tie_mm) continue;
    if (f.flipped) c.z_centre = -c.z_centre;
    c.z = {c.z_centre - extent, c.z_centre + extent};
    const Support s = support(table, f, box, c.borders_mask);
    if (s == Support::none) continue;
    c.full = s == Support::full;
    kept.push_back(c);
    if (!c.full) continue;
    const int last = static_cast<int>(kept.size()) - 1;
    if (c.z.lowest >= 0 && c.z.highest <= f.gap_mm && (above < 0 || c.z.highest < kept[above].z.highest))
      above = last;
    if (c.z.highest < 0 && c.z.lowest >= -f.gap_mm && (below < 0 || c.z.lowest > kept[below].z.lowest))
      below = last;
  }
  const Candidate front_above = above < 0 ? Candidate{} : kept[above];
  const Candidate front_below = below < 0 ? Candidate{} : kept[below];
  // Farther from every sample than the server, on the same side.
  std::erase_if(kept, [&](const Candidate& c) {
    const bool is_above = c.z.lowest >= 0, is_below = c.z.highest < 0;
    if ((is_above ? above : is_below ? below : -1) < 0) return false;
    const Candidate& server = is_above ? front_above : front_below;
    if (server.frame == c.frame) return false;
    const AffineScalar near = oriented_z(table.frames[server.frame]), far = oriented_z(table.frames[c.frame]);
    const Span farther = span_of({far.gradient - near.gradient, far.offset - near.offset}, box);
    return is_above ? farther.lowest > tie_mm : farther.highest < -tie_mm;
  });
}

}  // namespace sonoband
