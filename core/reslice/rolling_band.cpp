#include "core/reslice/rolling_band.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/reslice/frame_table.h"
#include "core/reslice/layer_kernels.h"
#include "core/reslice/paint.h"

namespace sonoband {
namespace {

constexpr int strip_rows = 16;  // compounded by one thread at a time
// Of layers got ready, between two looks at the stop flag: about half a millisecond.
constexpr int portions_in_turn = 4;

bool same_picture(const ReslicePlane& a, const ReslicePlane& b) {
  // Axes that differ by less turn a plane of 1000 pixels by less than a thousandth of a pixel.
  constexpr double turned = 1e-6;
  return (a.right.v - b.right.v).norm() < turned && (a.down.v - b.down.v).norm() < turned &&
         a.width == b.width && a.height == b.height && a.pixel_mm == b.pixel_mm;
}

std::uint8_t missing_of(Compounding how) {
  return how == Compounding::minimum ? 255 : 0;
}

PixelKind kind_of(const PreparedSweep& sweep) {
  const SweepView view = sweep.view();
  return view.frames.empty() ? PixelKind::grey : view.frames.front()->bscan.kind;
}

// Sums of Doppler pictures are not kept.
bool keeps_layers(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings) {
  return plane.width > 0 && plane.height > 0 &&
         !(kind_of(sweep) == PixelKind::doppler && settings.compounding == Compounding::mean);
}

// The block that holds a layer; layers may be negative.
int block_of(int layer) {
  static_assert((RollingBand::block_layers & (RollingBand::block_layers - 1)) == 0);
  return layer >> std::countr_zero(static_cast<unsigned>(RollingBand::block_layers));
}

}  // namespace

RollingBand::Window RollingBand::window_of(int offset, const RenderSettings& settings) {
  const int side = settings.band.layers() / 2;
  return {offset - side, offset + side};
}

void RollingBand::clear() {
  begun_ = false;
  forget();
  spare_blocks_.clear();
  spare_runs_.clear();
  counts_ = {};
  sums_ = {};
}

// All layers but not their memory: pages that come anew cost as much as painting them.
void RollingBand::forget() {
  for (auto& [index, block] : blocks_) spare_blocks_.push_back(std::move(block.layers));
  for (auto& [run, pixels] : runs_) spare_runs_.push_back(std::move(pixels));
  blocks_.clear();
  runs_.clear();
  counted_ = {};
  layers_painted_ = 0;
}

std::size_t RollingBand::bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(std::max(plane_.width, 0)) * std::max(plane_.height, 0);
  return pixels * ((block_layers + 1) * (blocks_.size() + spare_blocks_.size()) + runs_.size() +
                   spare_runs_.size() + (blocks_.empty() ? 0 : 6));
}

bool RollingBand::follows(const PreparedSweep& sweep, const ReslicePlane& plane,
                          const RenderSettings& settings, int& offset) const {
  if (!begun_ || sweep.view().frames.size() != frames_ || !same_picture(plane, plane_) ||
      settings.interpolation != settings_.interpolation ||
      settings.thin_dense_frames != settings_.thin_dense_frames ||
      settings.band.step_mm != settings_.band.step_mm) {
    return false;
  }
  constexpr double off_steps = 1e-3;
  const Eigen::Vector3d moved = (plane.origin.v - plane_.origin.v) / settings.band.step_mm;
  const double whole = std::round(moved.dot(plane_.normal().v));
  if ((moved - whole * plane_.normal().v).norm() > off_steps) return false;
  // A jump to where nothing is kept is a new picture.
  const int layers = settings.band.layers();
  if (std::abs(whole - offset_) > layers) return false;
  offset = static_cast<int>(whole);
  return true;
}

void RollingBand::begin(const PreparedSweep& sweep, const ReslicePlane& plane,
                        const RenderSettings& settings) {
  if (plane.width != plane_.width || plane.height != plane_.height) clear();
  forget();
  begun_ = true;
  plane_ = plane;
  settings_ = settings;
  frames_ = sweep.view().frames.size();
  offset_ = 0;
}

std::shared_ptr<const FrameTable> RollingBand::table_of(PreparedSweep& sweep) {
  const auto lent = [](const FrameTable& table) {
    return std::shared_ptr<const FrameTable>(std::shared_ptr<void>(), &table);
  };
  auto table = settings_.thin_dense_frames ? sweep.prepare_thinned(plane_.pixel_mm, settings_.interpolation)
                                           : lent(sweep.prepare());
  left_out_ = static_cast<int>(sweep.view().frames.size() - table->frames.size());
  strips_ = LayerStrips::count(*table, lattice_of_block(0));
  return table;
}

int RollingBand::strips_left(int block) const {
  const auto found = blocks_.find(block);
  return found == blocks_.end() ? strips_ : strips_ - found->second.strips;
}

// The band that follows is at `offset`; what lies far from it goes.
void RollingBand::move_to(int offset, const RenderSettings& settings, Parallel& parallel) {
  if (missing_ != missing_of(settings.compounding)) fill_gaps(missing_of(settings.compounding), parallel);
  settings_ = settings;
  offset_ = offset;
  forget_far(window_of(offset, settings));
}

BandImage RollingBand::render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                              Parallel& parallel, const StopFlag* stop) {
  if (!keeps_layers(sweep, plane, settings)) return render_planar(sweep, plane, settings, parallel, stop);
  int offset = 0;
  const bool follow = follows(sweep, plane, settings, offset);
  const bool still = offset == offset_ && settings.band.layers() == settings_.band.layers();
  if (!follow || (blocks_.empty() && still)) {
    begin(sweep, plane, settings);
    return render_planar(sweep, plane, settings, parallel, stop);
  }
  const Window before = window_of(offset_, settings_), band = window_of(offset, settings);
  move_to(offset, settings, parallel);
  paint_missing(*table_of(sweep), before, band, parallel);
  BandImage image = compound(band, parallel);
  image.kind = kind_of(sweep);
  image.frames_left_out = left_out_;
  return image;
}

bool RollingBand::prepare(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                          Parallel& parallel, const StopFlag* stop) {
  if (!keeps_layers(sweep, plane, settings)) return true;
  int offset = 0;
  if (!follows(sweep, plane, settings, offset)) begin(sweep, plane, settings);
  move_to(offset, settings, parallel);
  const std::shared_ptr<const FrameTable> table = table_of(sweep);
  const Window band = window_of(offset, settings);
  const int lowest = block_of(band.first), highest = block_of(band.last);
  std::vector<int> wanted;
  for (int block = lowest; block <= highest; ++block) wanted.push_back(block);
  wanted.push_back(highest + 1);
  wanted.push_back(lowest - 1);
  std::vector<Portion> portions;
  for (const int block : wanted) {
    while (strips_left(block) > 0) {
      if (stop != nullptr && stop->load(std::memory_order_relaxed)) return false;
      portions.clear();
      add_portions(block, std::min(strips_left(block), portions_in_turn * parallel.width()), portions);
      paint_portions(*table, portions, parallel);
    }
  }
  // Counts, sums and runs as well.
  if (counted_.empty()) compound(band, parallel);
  return true;
}

std::optional<int> RollingBand::layers_missing(const PreparedSweep& sweep, const ReslicePlane& plane,
                                               const RenderSettings& settings) const {
  int offset = 0;
  if (!keeps_layers(sweep, plane, settings) || blocks_.empty() || !follows(sweep, plane, settings, offset))
    return std::nullopt;
  const Window band = window_of(offset, settings);
  int missing = 0;
  for (int block = block_of(band.first); block <= block_of(band.last); ++block)
    if (strips_left(block) > 0) missing += block_layers;
  return missing;
}

std::size_t RollingBand::most_bytes(const ReslicePlane& plane, const RenderSettings& settings) {
  const std::size_t pixels = static_cast<std::size_t>(std::max(plane.width, 0)) * std::max(plane.height, 0);
  const auto layers = static_cast<std::size_t>(settings.band.layers());
  const std::size_t most_layers = layers + layers / 2 + 32;
  return pixels *
         (2 * most_layers + most_layers / block_layers + 6 + 2 * (block_layers + 1) + 2 * block_layers);
}

// Extremes of the other kind: other values where there is no data.
void RollingBand::fill_gaps(std::uint8_t missing, Parallel& parallel) {
  missing_ = missing;
  for (auto& [run, pixels] : runs_) give_back(std::move(pixels));
  runs_.clear();
  parallel.for_each(plane_.height, [&](int y) {
    for (auto& [index, block] : blocks_) {
      const std::uint8_t* has = block.layers.has_data.view().row(y);
      for (int l = 0; l < block_layers; ++l) {
        std::uint8_t* values = block.layers.values_row(l, y);
        for (int x = 0; x < plane_.width; ++x) values[x] = (has[x] >> l & 1) != 0 ? values[x] : missing;
      }
    }
  });
}

RollingBand::Layer RollingBand::layer(int index) const {
  const int block = block_of(index);
  return {&blocks_.at(block).layers, index - block * block_layers};
}

Pixels RollingBand::take_run() {
  if (spare_runs_.empty()) return {plane_.width, plane_.height};
  Pixels pixels = std::move(spare_runs_.back());
  spare_runs_.pop_back();
  return pixels;
}

void RollingBand::give_back(Pixels pixels) {
  if (spare_runs_.size() < 2 * block_layers) spare_runs_.push_back(std::move(pixels));
}

// Blocks farther from the band than a quarter of its thickness go; what is nearer stays for a drag that turns
// back.
void RollingBand::forget_far(const Window& band) {
  const int room = (band.last - band.first + 1) / 4 + block_layers;
  const Window kept{block_of(band.first - room), block_of(band.last + room)};
  // What is counted must be at hand to be taken off.
  if (!counted_.empty() && !(kept.holds(block_of(counted_.first)) && kept.holds(block_of(counted_.last))))
    counted_ = {};
  for (auto entry = blocks_.begin(); entry != blocks_.end();) {
    if (kept.holds(entry->first)) {
      ++entry;
      continue;
    }
    if (spare_blocks_.size() < 2) spare_blocks_.push_back(std::move(entry->second.layers));
    entry = blocks_.erase(entry);
  }
  for (auto entry = runs_.begin(); entry != runs_.end();) {
    const Run& run = entry->first;
    if (kept.holds(block_of(run.first)) && kept.holds(block_of(run.first + (1 << run.level) - 1))) {
      ++entry;
      continue;
    }
    give_back(std::move(entry->second));
    entry = runs_.erase(entry);
  }
}

Lattice RollingBand::lattice_of_block(int block) const {
  const double step = settings_.band.step_mm;
  Lattice lattice;
  lattice.origin = (plane_.origin + (block * block_layers * step) * plane_.normal()).v;
  lattice.per_sample = (plane_.pixel_mm * plane_.right).v;
  lattice.per_row = (plane_.pixel_mm * plane_.down).v;
  lattice.per_layer = (step * plane_.normal()).v;
  lattice.samples = plane_.width;
  lattice.rows = plane_.height;
  lattice.layers = block_layers;
  return lattice;
}

// The block's next strips.
void RollingBand::add_portions(int block, int strips, std::vector<Portion>& portions) {
  auto found = blocks_.find(block);
  if (found == blocks_.end()) {
    if (spare_blocks_.empty()) spare_blocks_.emplace_back(plane_.width, plane_.height, block_layers);
    found = blocks_.emplace(block, Block{std::move(spare_blocks_.back())}).first;
    spare_blocks_.pop_back();
  }
  Block& b = found->second;
  for (const int end = b.strips + strips; b.strips < end; ++b.strips) portions.push_back({block, b.strips});
  if (strips > 0 && b.strips == strips_) layers_painted_ += block_layers;
}

void RollingBand::paint_portions(const FrameTable& table, const std::vector<Portion>& portions,
                                 Parallel& parallel) {
  RenderSettings thin = settings_;
  thin.compounding = missing_ == 0 ? Compounding::maximum : Compounding::minimum;
  std::map<int, LayerStrips> of_block;
  for (const Portion& portion : portions)
    of_block.try_emplace(portion.block, table, lattice_of_block(portion.block), thin);
  parallel.for_each(static_cast<int>(portions.size()), [&](int i) {
    const Portion& portion = portions[i];
    of_block.at(portion.block).paint(portion.strip, blocks_.at(portion.block).layers);
  });
}

void RollingBand::paint_missing(const FrameTable& table, const Window& before, const Window& band,
                                Parallel& parallel) {
  const bool first = blocks_.empty();
  std::vector<Portion> portions;
  const int lowest = block_of(band.first), highest = block_of(band.last);
  for (int block = lowest; block <= highest; ++block) add_portions(block, strips_left(block), portions);
  // Ahead: what remains of a block over the steps that remain until it is reached.
  const auto ahead = [&](int block, int moved, int until_reached) {
    if (first || moved <= 0) return;
    const int steps = until_reached / moved + 1;
    add_portions(block, (strips_left(block) + steps - 1) / steps, portions);
  };
  ahead(highest + 1, band.last - before.last, (highest + 1) * block_layers - 1 - band.last);
  ahead(lowest - 1, before.first - band.first, band.first - lowest * block_layers);
  paint_portions(table, portions, parallel);
}

std::vector<RollingBand::Run> RollingBand::runs_of(const Window& band) const {
  std::vector<Run> runs;
  for (int first = band.first; first <= band.last;) {
    int level = 0;
    while ((first & ((2 << level) - 1)) == 0 && first + (2 << level) - 1 <= band.last) ++level;
    runs.push_back({level, first});
    first += 1 << level;
  }
  return runs;
}

// Appends to to_build what must be made for a run, halves first.
void RollingBand::need(const Run& run, std::vector<Run>& to_build) {
  if (run.level == 0 || runs_.contains(run)) return;
  need({run.level - 1, run.first}, to_build);
  need({run.level - 1, run.first + (1 << (run.level - 1))}, to_build);
  runs_.emplace(run, take_run());
  to_build.push_back(run);
}

ConstPixels RollingBand::pixels_of(const Run& run) const {
  if (run.level > 0) return runs_.at(run).view();
  const Layer l = layer(run.first);
  return {l.block->values_row(l.index, 0), plane_.width, plane_.height, l.block->values.width()};
}

// By block, so that all of its layers are counted in one go.
std::vector<RollingBand::Marks> RollingBand::marks_of(const std::vector<int>& layers) const {
  std::vector<Marks> marks;
  for (const int i : layers) {
    const Layer l = layer(i);
    if (marks.empty() || marks.back().block != l.block) marks.push_back({l.block, 0});
    marks.back().layers = static_cast<std::uint8_t>(marks.back().layers | LayerBlock::bits(l.index, 1));
  }
  return marks;
}

BandImage RollingBand::compound(const Window& band, Parallel& parallel) {
  const int width = plane_.width, height = plane_.height;
  const Compounding how = settings_.compounding;
  const bool mean = how == Compounding::mean, minimum = how == Compounding::minimum;

  // Layers that come and go since the last picture, or all of them where that is less.
  std::vector<int> come, gone;
  for (int i = counted_.first; i <= counted_.last; ++i)
    if (!band.holds(i)) gone.push_back(i);
  for (int i = band.first; i <= band.last; ++i)
    if (!counted_.holds(i)) come.push_back(i);
  const auto layers = static_cast<std::size_t>(band.last - band.first) + 1;
  const bool anew = counted_.empty() || (mean && !summed_) || come.size() + gone.size() > layers;
  if (anew) {
    counts_ = ImageBuffer<std::uint16_t>(width, height);
    sums_ = mean ? ImageBuffer<std::uint32_t>(width, height) : ImageBuffer<std::uint32_t>();
    gone.clear();
    come.clear();
    for (int i = band.first; i <= band.last; ++i) come.push_back(i);
    summed_ = mean;
  }
  counted_ = band;
  summed_ = summed_ && mean;

  const std::vector<Run> runs = mean ? std::vector<Run>() : runs_of(band);
  std::vector<Run> to_build;
  for (const Run& run : runs) need(run, to_build);
  struct Build {
    ConstPixels first, second;
    Pixels* both;
  };
  std::vector<Build> builds;
  for (const Run& run : to_build) {
    const int half = 1 << (run.level - 1);
    builds.push_back({pixels_of({run.level - 1, run.first}), pixels_of({run.level - 1, run.first + half}),
                      &runs_.at(run)});
  }
  std::vector<ConstPixels> parts;
  for (const Run& run : runs) parts.push_back(pixels_of(run));

  const std::vector<Marks> marks_come = marks_of(come), marks_gone = marks_of(gone);
  std::vector<ConstPixels> values_come, values_gone;
  if (mean) {
    for (const int i : come) values_come.push_back(pixels_of({0, i}));
    for (const int i : gone) values_gone.push_back(pixels_of({0, i}));
  }

  BandImage image{Pixels(width, height), ImageBuffer<std::uint16_t>(width, height), PixelKind::grey};
  const LayerKernels& kernels = layer_kernels();
  parallel.for_each((height + strip_rows - 1) / strip_rows, [&](int strip) {
    std::vector<const std::uint8_t*> rows(parts.size());
    for (int y = strip * strip_rows; y < std::min((strip + 1) * strip_rows, height); ++y) {
      for (const Build& build : builds) {
        const std::uint8_t* halves[2] = {build.first.row(y), build.second.row(y)};
        kernels.fold(halves, 2, minimum, width, build.both->view().row(y));
      }
      std::uint16_t* counts = counts_.view().row(y);
      std::uint32_t* sums = mean ? sums_.view().row(y) : nullptr;
      const auto count = [&](const Marks& m, bool add) {
        kernels.count(m.block->has_data.view().row(y), m.layers, add, width, counts);
      };
      for (const Marks& m : marks_come) count(m, true);
      for (const Marks& m : marks_gone) count(m, false);
      for (const ConstPixels& v : values_come) kernels.sum(v.row(y), true, width, sums);
      for (const ConstPixels& v : values_gone) kernels.sum(v.row(y), false, width, sums);
      std::uint8_t* pixels = image.pixels.view().row(y);
      if (mean) {
        kernels.mean(sums, counts, width, pixels);
      } else {
        for (std::size_t i = 0; i < parts.size(); ++i) rows[i] = parts[i].row(y);
        kernels.fold(rows.data(), static_cast<int>(rows.size()), minimum, width, pixels);
        if (minimum) kernels.blank(counts, width, pixels);
      }
      std::copy_n(counts, width, image.coverage.view().row(y));
    }
  });
  return image;
}

}  // namespace sonoband
