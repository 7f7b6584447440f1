#include "core/reslice/patch.h"

#include <algorithm>
#include <cmath>

namespace sonoband {
namespace {

// Offsets in 1/65536 pixel must keep well inside 31 bits together with positions.
constexpr double most_px = 8000;

}  // namespace

LaneGrid lane_grid(LaneShape shape) {
  LaneGrid grid;
  for (int k = 0; k < patch_lanes; ++k) {
    grid.a[k] = static_cast<float>(k % shape.across);
    grid.b[k] = static_cast<float>(k / shape.across);
  }
  return grid;
}

FixedPx fixed_position(double foot_px) {
  // Two sums of numbers cut off after 16 bits fall short by less than 2^-15 pixel.
  return std::llround((foot_px + 0.5 + 1.0 / 32768) * fixed_per_px);
}

bool make_patch_frame(const FrameEntry& frame, const FootSteps& steps, LaneShape shape, PatchFrame& out) {
  const auto offset = [&](double per_sample, double per_row, int k) {
    return per_sample * (k % shape.across) + per_row * (k / shape.across);
  };
  const int right = shape.across - 1, down = shape.down() - 1;
  if (std::abs(steps.x_per_sample) * right + std::abs(steps.x_per_row) * down > most_px ||
      std::abs(steps.y_per_sample) * right + std::abs(steps.y_per_row) * down > most_px ||
      frame.width > most_px || frame.height > most_px) {
    return false;
  }
  out.pixels = frame.pixels;
  out.stride = frame.stride;
  out.width = frame.width;
  out.height = frame.height;
  int greatest_column = -(1 << 20), greatest_row = greatest_column;
  out.least_column = out.least_row = 1 << 20;
  out.least_y = 1 << 30;
  out.greatest_y = -(1 << 30);
  for (int k = 0; k < patch_lanes; ++k) {
    out.offset_x[k] =
        static_cast<std::int32_t>(std::floor(65536 * offset(steps.x_per_sample, steps.x_per_row, k)));
    out.offset_y[k] =
        static_cast<std::int32_t>(std::floor(65536 * offset(steps.y_per_sample, steps.y_per_row, k)));
    out.part_x[k] = static_cast<std::uint16_t>(out.offset_x[k] & 0xffff);
    out.part_y[k] = static_cast<std::uint16_t>(out.offset_y[k] & 0xffff);
    out.least_column = std::min(out.least_column, out.offset_x[k] >> 16);
    out.least_row = std::min(out.least_row, out.offset_y[k] >> 16);
    greatest_column = std::max(greatest_column, out.offset_x[k] >> 16);
    greatest_row = std::max(greatest_row, out.offset_y[k] >> 16);
    out.least_y = std::min(out.least_y, out.offset_y[k]);
    out.greatest_y = std::max(out.greatest_y, out.offset_y[k]);
  }
  for (int k = 0; k < patch_lanes; ++k) {
    out.column[k] = static_cast<std::uint8_t>((out.offset_x[k] >> 16) - out.least_column);
    out.row[k] = static_cast<std::uint8_t>((out.offset_y[k] >> 16) - out.least_row);
  }
  out.columns = greatest_column - out.least_column;
  out.rows = greatest_row - out.least_row;
  // A carry adds one column and one row to what the lanes span.
  const bool fits_rows = out.columns + 1 < 128 && out.rows + 1 < 128;
  const bool fits_window =
      out.columns + 1 < 16 && out.rows + 1 < 16 && frame.width >= 16 && frame.height >= 16;
  if (fits_rows && (out.rows <= 1 || (!fits_window && out.rows < 24))) {
    out.fetch = Fetch::rows;
  } else {
    out.fetch = fits_window ? Fetch::window : Fetch::single;
  }
  return true;
}

}  // namespace sonoband
