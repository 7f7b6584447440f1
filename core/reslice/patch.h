// A patch is 64 samples of every layer, painted together: lane k of each layer is sample (k % across, k /
// across) of a small rectangle of the picture. What is affine over the picture is affine over lanes and
// layers, so a patch needs of a frame one position per layer and one offset per lane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/reslice/frame_table.h"
#include "core/reslice/layer_block.h"

namespace sonoband {

constexpr int patch_lanes = 64;
// Layers painted in one go, so that counts fit a byte and sums of bytes 16 bits. Thicker bands come in
// pieces.
constexpr int patch_layers = 128;

// A rectangle of lanes, or one sheared along the frames' traces: every row begins so many samples farther on
// than the one above it, or every column so many rows farther down, rounded. Patches at multiples of across
// and down then cover the picture as rectangles do.
struct LaneShape {
  int across = 64;                                  // samples along a line: 1, 2, 4 ... 64
  double samples_per_row = 0, rows_per_sample = 0;  // of which one at least is 0
  int down() const { return patch_lanes / across; }
  bool sheared() const { return samples_per_row != 0 || rows_per_sample != 0; }
  int a(int lane) const {
    const int row = lane / across;
    return lane % across + rounded(samples_per_row * row);
  }
  int b(int lane) const { return lane / across + rounded(rows_per_sample * (lane % across)); }

 private:
  static int rounded(double x) { return static_cast<int>(std::lround(x)); }
};

using LaneMask = std::uint64_t;  // bit k: lane k

// Lanes beside one another in a row of the picture.
struct LaneRun {
  int lane = 0, count = 0;  // the first; how many
  int a = 0, b = 0;         // of the first
};

// Where the lanes lie, from lane 0: samples along the line, rows down.
struct alignas(64) LaneGrid {
  std::array<float, patch_lanes> a, b;
  std::array<LaneRun, patch_lanes> runs;
  int run_count = 0;
  int least_a = 0, greatest_a = 0, least_b = 0, greatest_b = 0;
};
LaneGrid lane_grid(LaneShape shape);

// Lengths along the picture's axes in 1/2^32 of a B-scan pixel: exact sums, in any order, on any machine.
using FixedPx = std::int64_t;
constexpr double fixed_per_px = 4294967296.0;

// From a position (fixed_position) to the foot itself, whose whole part is the upper left of its four taps.
constexpr FixedPx foot_from_position = -((FixedPx{1} << 31) + (FixedPx{1} << 17));

// How a frame's pixels are fetched for 64 lanes at once.
enum class Fetch : std::uint8_t {
  rows,    // lanes lie on few pixel rows: up to 127 pixels of each
  window,  // lanes lie within 16 x 16 pixels
  single,  // lane by lane
};

// One frame as a patch of one shape sees it, wherever the patch is. `single` works for any geometry; the
// other tables are for kernels with byte permutes.
struct alignas(64) PatchFrame {
  // Whole and fractional pixels from lane 0, in 1/65536.
  std::array<std::int32_t, patch_lanes> offset_x, offset_y;
  std::array<std::uint16_t, patch_lanes> part_x, part_y;  // the fractional parts
  std::array<std::uint8_t, patch_lanes> column, row;      // the whole parts less the least
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0, height = 0;
  int first_x = 0, last_x = 0, first_y = 0, last_y = 0;  // of the pixels that are the picture's
  const std::uint8_t* mask = nullptr;  // non-zero where the picture counts; null: wherever it has pixels
  std::ptrdiff_t mask_stride = 0;
  int least_column = 0, least_row = 0;       // of the whole parts
  int columns = 0, rows = 0;                 // greatest whole part less the least
  std::int32_t least_y = 0, greatest_y = 0;  // of offset_y
  Fetch fetch = Fetch::single;
};

// What a patch has gathered from up to patch_layers layers. Only the fields of the rule in use are kept.
struct alignas(64) PatchSums {
  std::array<std::uint8_t, patch_lanes> extreme;
  std::array<std::uint8_t, patch_lanes> count;     // layers with data
  std::array<std::uint8_t, patch_lanes> coloured;  // of them
  std::array<std::uint16_t, patch_lanes> sum;      // of grey
  std::array<std::int16_t, patch_lanes> velocity;  // of coloured, levels
};

// A patch's layers apart.
struct alignas(64) PatchLayers {
  std::array<std::array<std::uint8_t, patch_lanes>, LayerBlock::most_layers> values;
  std::array<std::uint16_t, patch_lanes> has_data;  // of a lane; bit l: of layer l
};

enum class Rule : std::uint8_t { maximum, minimum, mean_grey, mean_doppler };

// For each lane the layer where an affine condition changes: true from that layer on, or up to it.
struct alignas(64) LayerThresholds {
  std::array<std::uint8_t, patch_lanes> layer;
  bool rising = true;  // condition holds for l >= layer; else for l < layer
};

// Where patches of a tile begin: samples and rows from the tile's corner, which layers, which lanes exist.
struct PatchSite {
  int da = 0, db = 0;
  int depth = 0;  // layers first .. depth - 1 of the piece the boundaries were laid out for
  LaneMask lanes = 0;
  int start = 0;  // a cell near the first, such as the first of the patch beside it
  int first = 0;
};

// Rows of a picture that are still to be asked for: memory's answers overlap, where the kernels' loads would
// come one by one.
struct RowsAhead {
  const std::uint8_t* row = nullptr;  // first pixel of the next
  std::ptrdiff_t stride = 0;
  int columns = 0, rows = 0;

  void ask() {
    if (rows <= 0) return;
    for (int x = 0; x < columns; x += 64) __builtin_prefetch(row + x);
    __builtin_prefetch(row + columns - 1);
    row += stride;
    --rows;
  }
  void ask_all() {
    while (rows > 0) ask();
  }
};

// Patches of a tile that a chain's cells are taken in, cell after cell.
constexpr int group_patches = 256;
struct alignas(64) PatchGroup {
  alignas(64) std::array<float, group_patches> da, db;  // of the sites
  std::array<PatchSite, group_patches> sites;           // all of the same layers
  std::array<PatchSums, group_patches> sums;
  int count = 0;
  int least_da = 0, greatest_da = 0, least_db = 0, greatest_db = 0;  // of the sites
  RowsAhead ahead;  // of a frame soon to be taken, some with each patch: asked for all at once they would be
                    // waited for

  void add(const PatchSite& site) {
    least_da = count == 0 ? site.da : std::min(least_da, site.da);
    greatest_da = count == 0 ? site.da : std::max(greatest_da, site.da);
    least_db = count == 0 ? site.db : std::min(least_db, site.db);
    greatest_db = count == 0 ? site.db : std::max(greatest_db, site.db);
    da[count] = static_cast<float>(site.da);
    db[count] = static_cast<float>(site.db);
    sites[count++] = site;
  }
};

// An affine condition over a tile, value >= 0, by the layer at which it changes: for each lane that of lane 0
// plus a constant. In layers, so that a value that hardly changes from layer to layer changes far away.
struct alignas(64) ChainBoundary {
  std::array<float, patch_lanes> lanes;  // from lane 0, in the order the instruction set likes
  float least = 0, greatest = 0;         // of lanes
  float first = 0, per_sample = 0, per_row = 0;
  bool rising = true;  // holds from there on, else up to there
  bool always = false, never = false;

  float at(const PatchSite& site) const {
    return first + (per_sample * static_cast<float>(site.da) + per_row * static_cast<float>(site.db));
  }
};

// A frame as a chain's cells take it: the position of lane 0 is affine over a tile.
struct ChainFrame {
  const PatchFrame* frame = nullptr;
  FixedPx x = 0, x_per_sample = 0, x_per_row = 0,
          x_per_layer = 0;  // at the tile's corner, layer 0 of the piece
  FixedPx y = 0, y_per_sample = 0, y_per_row = 0, y_per_layer = 0;

  FixedPx x_at(const PatchSite& p, int l) const {
    return x + p.da * x_per_sample + p.db * x_per_row + l * x_per_layer;
  }
  FixedPx y_at(const PatchSite& p, int l) const {
    return y + p.da * y_per_sample + p.db * y_per_row + l * y_per_layer;
  }
};

// An affine function over a tile, in mm, from its corner and layer 0 of the piece.
struct TileDistance {
  float first = 0, per_sample = 0, per_row = 0, per_layer = 0;
  float at(const PatchSite& p, int l) const {
    return first + (per_sample * static_cast<float>(p.da) + per_row * static_cast<float>(p.db)) +
           per_layer * static_cast<float>(l);
  }
};

// The same in 1/2^32 of a unit.
struct TileFixed {
  FixedPx first = 0, per_sample = 0, per_row = 0, per_layer = 0;
  FixedPx at(const PatchSite& p, int l) const {
    return first + p.da * per_sample + p.db * per_row + l * per_layer;
  }
};

// Weights of two frames' values sum to this, which also takes 1/255 level to 1/128: 2^15 128 / 255.
constexpr int share_full = 16448;
constexpr int bend_full = 32768;

// How two neighbours of a chain share the samples between them: the second has z / gap, z being the distance
// from the first and gap that between the two, > 0.
// Where the gap varies little about its middle m, that is part / (1 + bend) with part = z / m and bend = gap
// / m - 1, affine both: 16-bit numbers, right modulo 2^16 for any sample between the two, and the quotient a
// short series.
struct alignas(64) ChainShare {
  alignas(64) std::array<std::uint16_t, patch_lanes> part_lanes, bend_lanes;  // from lane 0, in lane order
  alignas(64) std::array<float, patch_lanes> z_lanes, gap_lanes;  // from lane 0, in the kernels' order
  TileFixed part, bend;                                           // in 1 / share_full and 1 / bend_full
  TileDistance z, gap;
  bool even = false;  // the gap varies so little: part and bend are kept, else z and gap
};

// What a frame gives to a layer of eight lines that follow no lattice; lane k is sample k % 8 of line k / 8.
struct RulingLayer {
  int layer = 0;
  int feet = 0;                              // where x and y come from
  LaneMask lanes = 0;                        // of lines that exist
  const FixedPx *x = nullptr, *y = nullptr;  // of each line's first sample; aligned to 64 bytes
  FixedPx least_x = 0, greatest_x = 0, least_y = 0, greatest_y = 0;  // of them
  // Per line the sample where the condition changes; null: it holds throughout (from), or never (to).
  const std::int16_t *from = nullptr, *to = nullptr;
};

// Eight lines' values at their first sample; one layer.
struct alignas(64) RuledValues {
  std::array<double, 8> of;
};

// Where along eight lines of a layer a condition begins to hold, or ceases to.
struct RulingChange {
  std::array<std::int16_t, 8> at;            // the sample; 0 .. samples + 2
  std::uint8_t everywhere = 0, nowhere = 0;  // a bit for each line: it holds all along it, or nowhere
};

// The condition first + i per_sample + offset >= 0 for the samples i of a line; `second` is added to first.
struct RulingCondition {
  const RuledValues *first = nullptr, *second = nullptr;  // by layer; second may be null
  double per_sample = 0, offset = 0;
  int samples = 0, layers = 0;
};

// A frame's cell: its layers, and how conditions change along the lines (holding from there on, or up to it).
struct RulingCell {
  const PatchFrame* frame = nullptr;  // of shape 8 x 8 with all rows at lane offset 0
  FixedPx x_per_sample = 0, y_per_sample = 0;
  int first = 0, last = 0;  // of the layers
  bool from_rising = true, to_rising = true;
};

// One of two frames to blend: feet (not positions) and distances at lane 0 of each layer.
struct LinearSide {
  const PatchFrame* frame = nullptr;
  const FixedPx* x = nullptr;
  const FixedPx* y = nullptr;
  const float* z = nullptr;  // mm
  float z_per_sample = 0, z_per_row = 0;
};

// Least and greatest offset of a patch's lanes.
struct OffsetSpan {
  std::int32_t least = 0, greatest = 0;
};

// A picture as kernels read it.
struct PictureRows {
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0, height = 0;
};

constexpr int least_turned_px = 16;  // the least width of a picture that is turned

// Pixels a frame's foot moves from sample to sample and from row to row.
struct FootSteps {
  double x_per_sample = 0, x_per_row = 0, y_per_sample = 0, y_per_row = 0;
};

// Patches of any shape keep positions of the frame within 8000 pixels of one another, as the tables need.
bool patches_hold(const FrameEntry& frame, double mm_per_sample, double mm_per_row);

// `taps`: pixels along x and along y that a sample takes. Precondition: patches_hold.
void make_patch_frame(const FrameEntry& frame, const FootSteps& steps, const LaneGrid& grid, int taps,
                      PatchFrame& out);

// The foot's coordinate in pixels as a position of lane 0: + 1/2, and so much more that sums of truncated
// numbers never fall below a boundary they are on.
inline FixedPx fixed_position(double foot_px) {
  // Two sums of numbers cut off after 16 bits fall short by less than 2^-15 pixel.
  const double position = (foot_px + 0.5 + 1.0 / 32768) * fixed_per_px;
  return static_cast<FixedPx>(position + (position < 0 ? -0.5 : 0.5));
}
}  // namespace sonoband
