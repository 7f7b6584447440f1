#include "core/reslice/paint.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/band_painter.h"
#include "core/reslice/plain_painter.h"
#include "core/reslice/ruling_painter.h"
#include "core/reslice/thinning.h"

namespace sonoband {
namespace {

constexpr int strip_area = 4 * 64 * 64;  // pixels, painted by one thread in turn
constexpr TileSize layer_tile;
constexpr int layer_strip_pixels = 2 * layer_tile.across;

// Where line (row, layer) of a plane starts.
Point<frame::World> line_start(const ReslicePlane& plane, const Band& band, int row, int layer) {
  return plane.origin + (row * plane.pixel_mm) * plane.down + band.offset_mm(layer) * plane.normal();
}

BandImage empty_image(int width, int height, PixelKind kind) {
  return {Pixels(std::max(width, 0), std::max(height, 0)),
          ImageBuffer<std::uint16_t>(std::max(width, 0), std::max(height, 0)), kind};
}

bool patches_hold_all(const FrameTable& table, double mm_per_sample, double mm_per_row) {
  return std::all_of(table.frames.begin(), table.frames.end(),
                     [&](const FrameEntry& f) { return patches_hold(f, mm_per_sample, mm_per_row); });
}
bool patches_hold_all(const FrameTable& table, const Lattice& lattice) {
  return patches_hold_all(table, lattice.per_sample.norm(), lattice.per_row.norm());
}

LineBundle lines_of(const Lattice& lattice) {
  LineBundle bundle;
  bundle.samples = lattice.samples;
  bundle.rows = lattice.rows;
  bundle.layers = lattice.layers;
  bundle.step = {lattice.per_sample};
  for (int row = 0; row < lattice.rows; ++row)
    for (int layer = 0; layer < lattice.layers; ++layer) bundle.starts.push_back({lattice.at(0, row, layer)});
  return bundle;
}

// Each layer as a picture of its own, by the plain kernel and on one thread: pixels so large are rare.
void paint_layers_plainly(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings,
                          LayerBlock& layers) {
  Serial serial;
  const std::uint8_t missing = settings.compounding == Compounding::minimum ? 255 : 0;
  Lattice thin = lattice;
  thin.layers = 1;
  for (int l = 0; l < lattice.layers; ++l) {
    thin.origin = lattice.at(0, 0, l);
    BandImage image = empty_image(lattice.samples, lattice.rows, table.kind);
    paint_plainly(table, lines_of(thin), settings, serial, nullptr, image);
    for (int y = 0; y < lattice.rows; ++y) {
      for (int x = 0; x < lattice.samples; ++x) {
        const bool has = image.coverage.view()(x, y) != 0;
        std::uint16_t& marks = layers.has_data.view()(x, y);
        marks = static_cast<std::uint16_t>((marks & ~LayerBlock::bits(l, 1)) |
                                           (has ? LayerBlock::bits(l, 1) : 0));
        layers.values_row(l, y)[x] = has ? image.pixels.view()(x, y) : missing;
      }
    }
  }
}

// Paints with the sweep's frames, or with those that stay when thinned.
template <class Surface>
BandImage paint_sweep(const SweepView& sweep, const RenderSettings& settings, double pixel_mm,
                      Parallel& parallel, const Surface& surface) {
  const FrameTable table = make_frame_table(sweep, settings.gap);
  if (!settings.thin_dense_frames) return paint(table, surface, settings, parallel, nullptr);
  const FrameTable kept = make_thinned_table(sweep, settings.gap, pixel_mm, settings.interpolation);
  return paint_thinned(table, kept, pixel_mm, surface, settings, parallel, nullptr);
}

OutputPixel output_pixel(const Lattice& lattice, double mm) {
  OutputPixel pixel{mm};
  const Eigen::Vector3d normal = lattice.per_sample.cross(lattice.per_row);
  if (normal.norm() == 0) return pixel;  // a single line
  pixel.axes.row(0) = lattice.per_sample.normalized();
  pixel.axes.row(1) = normal.cross(lattice.per_sample).normalized();
  pixel.axes.row(2) = normal.normalized();
  return pixel;
}

// In the mean over the tiles.
int frames_left_out(const FrameTable& table, const LeftOut& count) {
  if (count.reached == 0) return 0;
  return static_cast<int>(
      std::llround(static_cast<double>(table.frames.size()) * static_cast<double>(count.left_out) /
                   static_cast<double>(count.reached)));
}

// thinning.rest in World.
BandImage paint_tiles(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings,
                      Thinning thinning, Parallel& parallel, const std::atomic<bool>* stop) {
  BandImage image = empty_image(lattice.samples, lattice.rows, table.kind);
  if (lattice.samples <= 0 || lattice.rows <= 0 || table.frames.empty()) return image;
  if (!patches_hold_all(table, lattice)) {
    paint_plainly(table, lines_of(lattice), settings, parallel, stop, image);
    return image;
  }
  const FrameTable seen = seen_from(lattice, table);
  FrameTable rest;
  if (thinning.rest != nullptr) {
    rest = seen_from(lattice, *thinning.rest);
    thinning.rest = &rest;
  }
  const Lattice own = in_own_coordinates(lattice);
  const TileSize size = tile_size(seen, lattice.layers, settings.interpolation);
  const int strip_pixels = std::max(size.across, strip_area / size.down);
  const int across = (lattice.samples + strip_pixels - 1) / strip_pixels;
  const int down = (lattice.rows + size.down - 1) / size.down;
  struct Counts {
    LeftOut left_out;
    bool turned_parts = false;
  };
  std::vector<Counts> of_strips(static_cast<std::size_t>(across) * down);
  parallel.for_each(across * down, [&](int strip) {
    BandPainter painter(seen, settings, image, stop, thinning);
    const int a = strip % across * strip_pixels;
    painter.paint_strips(own, {{a, strip / across * size.down, std::min(strip_pixels, lattice.samples - a)}},
                         size);
    of_strips[strip] = {painter.left_out(), painter.turned_parts()};
  });
  LeftOut sum;
  for (const Counts& of_strip : of_strips) {
    sum.reached += of_strip.left_out.reached;
    sum.left_out += of_strip.left_out.left_out;
    image.turned_parts = image.turned_parts || of_strip.turned_parts;
  }
  image.frames_left_out = frames_left_out(table, sum);
  return image;
}

}  // namespace

LineBundle plane_lines(const ReslicePlane& plane, const Band& band) {
  LineBundle bundle;
  bundle.samples = plane.width;
  bundle.rows = plane.height;
  bundle.layers = band.layers();
  bundle.step = plane.pixel_mm * plane.right;
  bundle.starts.reserve(static_cast<std::size_t>(bundle.rows) * bundle.layers);
  for (int row = 0; row < plane.height; ++row)
    for (int layer = 0; layer < bundle.layers; ++layer)
      bundle.starts.push_back(line_start(plane, band, row, layer));
  return bundle;
}

Lattice plane_lattice(const ReslicePlane& plane, const Band& band) {
  const int layers = band.layers();
  const auto start = [&](int row, int layer) { return line_start(plane, band, row, layer).v; };
  return lattice_through(start(0, 0), (plane.pixel_mm * plane.right).v, start(plane.height - 1, 0),
                         start(0, layers - 1), plane.width, plane.height, layers);
}

BandImage paint(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop) {
  return paint_tiles(table, lattice, settings, {}, parallel, stop);
}

BandImage paint_thinned(const FrameTable& table, const FrameTable& kept, double pixel_mm,
                        const Lattice& lattice, const RenderSettings& settings, Parallel& parallel,
                        const std::atomic<bool>* stop) {
  // A few frames less are not worth opening a tile twice.
  const bool fewer = kept.frames.size() <= table.frames.size() - table.frames.size() / 8;
  return paint_tiles(table, lattice, settings, {output_pixel(lattice, pixel_mm), fewer ? &kept : nullptr},
                     parallel, stop);
}

LayerStrips::LayerStrips(const FrameTable& table, const Lattice& lattice, const RenderSettings& settings)
    : table_(&table), lattice_(lattice), settings_(settings), in_patches_(patches_hold_all(table, lattice)) {
  if (in_patches_) seen_ = seen_from(lattice, table);
}

int LayerStrips::count(const FrameTable& table, const Lattice& lattice) {
  if (!patches_hold_all(table, lattice)) return 1;
  const int across = (lattice.samples + layer_strip_pixels - 1) / layer_strip_pixels;
  return across * ((lattice.rows + layer_tile.down - 1) / layer_tile.down);
}

void LayerStrips::paint(int first, int count, LayerBlock& layers) const {
  if (!in_patches_) {
    paint_layers_plainly(*table_, lattice_, settings_, layers);
    return;
  }
  const int across = (lattice_.samples + layer_strip_pixels - 1) / layer_strip_pixels;
  std::vector<BandPainter::Strip> strips;
  for (int strip = first; strip < first + count; ++strip) {
    const int a = strip % across * layer_strip_pixels;
    strips.push_back(
        {a, strip / across * layer_tile.down, std::min(layer_strip_pixels, lattice_.samples - a)});
  }
  BandPainter(seen_, settings_, layers).paint_strips(in_own_coordinates(lattice_), strips, layer_tile);
}

BandImage paint(const FrameTable& table, const LineBundle& bundle, const RenderSettings& settings,
                Parallel& parallel, const std::atomic<bool>* stop) {
  if (const std::optional<Lattice> lattice = lattice_of(bundle))
    return paint(table, *lattice, settings, parallel, stop);
  BandImage image = empty_image(bundle.samples, bundle.rows, table.kind);
  if (bundle.samples <= 0 || bundle.rows <= 0 || table.frames.empty()) return image;
  if (!patches_hold_all(table, bundle.step.v.norm(), 0)) {
    paint_plainly(table, bundle, settings, parallel, stop, image);
    return image;
  }
  const std::vector<int> all = all_frames(table);
  parallel.for_each((bundle.rows + rulings_in_turn - 1) / rulings_in_turn, [&](int block) {
    RulingPainter(table, bundle, settings, image, stop).paint(all, block * rulings_in_turn);
  });
  return image;
}

BandImage paint_thinned(const FrameTable& table, const FrameTable& kept, double pixel_mm,
                        const LineBundle& bundle, const RenderSettings& settings, Parallel& parallel,
                        const std::atomic<bool>* stop) {
  if (const std::optional<Lattice> lattice = lattice_of(bundle))
    return paint_thinned(table, kept, pixel_mm, *lattice, settings, parallel, stop);
  BandImage image = paint(kept, bundle, settings, parallel, stop);
  image.frames_left_out = static_cast<int>(table.frames.size() - kept.frames.size());
  return image;
}

BandImage render_lines(const SweepView& sweep, const LineBundle& bundle, const RenderSettings& settings,
                       Parallel& parallel) {
  return paint_sweep(sweep, settings, bundle.step.v.norm(), parallel, bundle);
}

BandImage render_planar(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                        Parallel& parallel) {
  return paint_sweep(sweep, settings, plane.pixel_mm, parallel, plane_lattice(plane, settings.band));
}

}  // namespace sonoband
