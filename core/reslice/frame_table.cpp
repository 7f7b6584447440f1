#include "core/reslice/frame_table.h"

#include <map>
#include <numeric>

#include "core/reslice/capture_order.h"

namespace sonoband {

MaskSums::MaskSums(MaskView mask) : width_(mask.width) {
  if (mask.empty()) return;
  const std::size_t stride = static_cast<std::size_t>(mask.width) + 1;
  std::vector<std::uint32_t> sums(stride * (static_cast<std::size_t>(mask.height) + 1), 0);
  for (int y = 0; y < mask.height; ++y) {
    std::uint32_t in_row = 0;
    for (int x = 0; x < mask.width; ++x) {
      in_row += mask(x, y) != 0 ? 1 : 0;
      sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + in_row;
    }
  }
  sums_ = std::make_shared<const std::vector<std::uint32_t>>(std::move(sums));
}

std::uint32_t MaskSums::kept(int x0, int y0, int x1, int y1) const {
  const std::size_t stride = static_cast<std::size_t>(width_) + 1;
  const auto at = [&](int x, int y) { return (*sums_)[static_cast<std::size_t>(y) * stride + x]; };
  return at(x1 + 1, y1 + 1) - at(x0, y1 + 1) - at(x1 + 1, y0) + at(x0, y0);
}

std::vector<int> all_frames(const FrameTable& table) {
  std::vector<int> all(table.frames.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

FrameTable make_frame_table(const SweepView& sweep, const GapLimit& gap) {
  FrameTable table;
  if (sweep.frames.empty()) return table;
  const std::vector<double> limits = gap_limits(sweep, gap);
  const std::vector<int> order = capture_order(sweep);
  std::map<std::int32_t, Eigen::Vector3d> normals;
  for (const int i : order) {
    const TrackedFrame& f = *sweep.frames[i];
    normals.try_emplace(f.sweep_id, Eigen::Vector3d::Zero()).first->second +=
        f.world_from_image.linear.col(2);
  }
  const Eigen::Vector3d first = normals.at(sweep.frames[order.front()]->sweep_id);
  table.frames.reserve(order.size());
  for (const int i : order) {
    const TrackedFrame& f = *sweep.frames[i];
    const auto row = [&](int r) {
      return AffineScalar{f.image_from_world.linear.row(r), f.image_from_world.translation[r]};
    };
    table.frames.push_back({row(0), row(1), row(2), row(2).gradient, limits[i],
                            normals.at(f.sweep_id).dot(first) < 0, f.bscan.pixels.data, f.bscan.pixels.stride,
                            f.bscan.pixels.width, f.bscan.pixels.height, nullptr, 0});
  }
  table.mask = sweep.mask;
  table.mask_sums = MaskSums(sweep.mask);
  table.kind = sweep.frames.front()->bscan.kind;
  return table;
}

}  // namespace sonoband
