#include "core/reslice/patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reslice/patch_kernels.h"

namespace sonoband {
namespace {

// Offsets in 1/65536 pixel must keep well inside 31 bits together with positions.
constexpr double most_px = 8000;

}  // namespace

LaneGrid lane_grid(LaneShape shape) {
  LaneGrid grid;
  for (int k = 0; k < patch_lanes; ++k) {
    const int a = shape.a(k), b = shape.b(k);
    grid.a[k] = static_cast<float>(a);
    grid.b[k] = static_cast<float>(b);
    grid.least_a = std::min(grid.least_a, a);
    grid.greatest_a = std::max(grid.greatest_a, a);
    grid.least_b = std::min(grid.least_b, b);
    grid.greatest_b = std::max(grid.greatest_b, b);
    if (k > 0 && k % shape.across != 0 && grid.runs[grid.run_count - 1].b == b) {
      ++grid.runs[grid.run_count - 1].count;
    } else {
      grid.runs[grid.run_count++] = {k, 1, a, b};
    }
  }
  return grid;
}

bool patches_hold(const FrameEntry& frame, double mm_per_sample, double mm_per_row) {
  const double px = (mm_per_sample + mm_per_row) * (patch_lanes - 1);
  return frame.width <= most_px && frame.height <= most_px && frame.x_px.gradient.norm() * px <= most_px &&
         frame.y_px.gradient.norm() * px <= most_px;
}

void make_patch_frame(const FrameEntry& frame, const FootSteps& steps, const LaneGrid& grid, int taps,
                      PatchFrame& out) {
  out.pixels = frame.pixels;
  out.stride = frame.stride;
  out.width = frame.width;
  out.height = frame.height;
  out.first_x = out.first_y = 0;
  out.last_x = frame.width - 1;
  out.last_y = frame.height - 1;
  out.mask = nullptr;
  const auto fixed = [](double px) { return std::llround(px * fixed_per_px); };
  const PatchKernels& kernels = patch_kernels();
  const auto [least_x, greatest_x] =
      kernels.lane_positions(grid, fixed(steps.x_per_sample), fixed(steps.x_per_row), out.offset_x.data());
  const auto [least_y, greatest_y] =
      kernels.lane_positions(grid, fixed(steps.y_per_sample), fixed(steps.y_per_row), out.offset_y.data());
  out.least_y = least_y;
  out.greatest_y = greatest_y;
  out.least_column = least_x >> 16;
  out.least_row = least_y >> 16;
  out.columns = (greatest_x >> 16) - out.least_column;
  out.rows = (greatest_y >> 16) - out.least_row;
  kernels.split_positions(out.offset_x.data(), out.least_column, out.part_x.data(), out.column.data());
  kernels.split_positions(out.offset_y.data(), out.least_row, out.part_y.data(), out.row.data());
  // A carry adds one column and one row to what the lanes span, and so does each tap beyond the first.
  const bool fits_rows = out.columns + taps < 128 && out.rows + taps < 128;
  const bool fits_window =
      out.columns + taps < 16 && out.rows + taps < 16 && frame.width >= 16 && frame.height >= 16;
  if (fits_rows && (out.rows <= 1 || (!fits_window && out.rows < 24))) {
    out.fetch = Fetch::rows;
  } else {
    out.fetch = fits_window ? Fetch::window : Fetch::single;
  }
}

}  // namespace sonoband
