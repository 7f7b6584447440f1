#include "core/reslice/rolling_band.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/frame_table.h"
#include "core/reslice/paint.h"

namespace sonoband {
namespace {

// Of layers got ready, between two looks at the stop flag: about half a millisecond.
constexpr int strips_in_turn = 2;
// Of what was forgotten.
constexpr std::size_t most_spare_blocks = 2, most_spare_runs = 16;
// For each pixel: which layers of a block have data; counts and sums.
constexpr std::size_t marks_bytes = 2, sums_bytes = 6;

// How far beside a band of so many layers a block is kept: the next one of a drag always is.
int room_beside(int layers) {
  constexpr int half = RollingBand::block_layers / 2;
  return std::max(layers / 4, half) + half;
}

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
  forget_nested();
  counted_ = {};
  layers_painted_ = 0;
}

std::size_t RollingBand::bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(std::max(plane_.width, 0)) * std::max(plane_.height, 0);
  return pixels * ((block_layers + marks_bytes) * (blocks_.size() + spare_blocks_.size()) + runs_.size() +
                   spare_runs_.size() + nested_.size() + (blocks_.empty() ? 0 : sums_bytes));
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
  const std::shared_ptr<const FrameTable> table = table_of(sweep);
  const bool first = blocks_.empty();
  paint_missing(*table, band, parallel);
  const std::vector<Portion> ahead = portions_ahead(before, band, first, parallel.width());
  BandImage image = compound(band, parallel, static_cast<int>(ahead.size()), painter_of(*table, ahead));
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
      const int strips = std::min(strips_left(block), strips_in_turn * parallel.width());
      add_portions(block, strips, parallel.width(), portions);
      parallel.for_each(static_cast<int>(portions.size()), painter_of(*table, portions));
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
  // The outermost blocks may hold one layer each that is near enough.
  const std::size_t most_layers = layers + 2 * room_beside(settings.band.layers()) + 2 * (block_layers - 1);
  const std::size_t blocks = most_layers * (block_layers + marks_bytes) / block_layers + 1;
  return pixels * (blocks + most_layers + most_nested + sums_bytes +
                   most_spare_blocks * (block_layers + marks_bytes) + most_spare_runs);
}

// Extremes of the other kind: other values where there is no data.
void RollingBand::fill_gaps(std::uint8_t missing, Parallel& parallel) {
  missing_ = missing;
  for (auto& [run, pixels] : runs_) give_back(std::move(pixels));
  runs_.clear();
  forget_nested();
  parallel.for_each(plane_.height, [&](int y) {
    for (auto& [index, block] : blocks_) {
      const std::uint16_t* has = block.layers.has_data.view().row(y);
      for (int l = 0; l < block_layers; ++l) {
        std::uint8_t* values = block.layers.values_row(l, y);
        for (int x = 0; x < plane_.width; ++x) values[x] = (has[x] >> l & 1) != 0 ? values[x] : missing;
      }
    }
  });
}

void RollingBand::give_back(Pixels pixels) {
  if (spare_runs_.size() < most_spare_runs) spare_runs_.push_back(std::move(pixels));
}

// Blocks far from the band go; what is nearer stays for a drag that turns back.
void RollingBand::forget_far(const Window& band) {
  const int room = room_beside(band.last - band.first + 1);
  const Window kept{block_of(band.first - room), block_of(band.last + room)};
  // What is counted must be at hand to be taken off.
  if (!counted_.empty() && !(kept.holds(block_of(counted_.first)) && kept.holds(block_of(counted_.last))))
    counted_ = {};
  for (auto entry = blocks_.begin(); entry != blocks_.end();) {
    if (kept.holds(entry->first)) {
      ++entry;
      continue;
    }
    if (spare_blocks_.size() < most_spare_blocks) spare_blocks_.push_back(std::move(entry->second.layers));
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

// The block's next strips in about `count` portions.
void RollingBand::add_portions(int block, int strips, int count, std::vector<Portion>& portions) {
  if (strips <= 0) return;
  auto found = blocks_.find(block);
  if (found == blocks_.end()) {
    if (spare_blocks_.empty()) spare_blocks_.emplace_back(plane_.width, plane_.height, block_layers);
    found = blocks_.emplace(block, Block{std::move(spare_blocks_.back())}).first;
    spare_blocks_.pop_back();
  }
  Block& b = found->second;
  const int portion = (strips + count - 1) / count;
  for (const int end = b.strips + strips; b.strips < end;) {
    const int some = std::min(portion, end - b.strips);
    portions.push_back({block, b.strips, some});
    b.strips += some;
  }
  if (b.strips == strips_) layers_painted_ += block_layers;
}

std::function<void(int)> RollingBand::painter_of(const FrameTable& table,
                                                 const std::vector<Portion>& portions) {
  RenderSettings thin = settings_;
  thin.compounding = missing_ == 0 ? Compounding::maximum : Compounding::minimum;
  std::map<int, LayerStrips> of_block;
  for (const Portion& portion : portions)
    of_block.try_emplace(portion.block, table, lattice_of_block(portion.block), thin);
  return [this, of_block = std::move(of_block), &portions](int i) {
    const Portion& portion = portions[i];
    of_block.at(portion.block).paint(portion.first, portion.strips, blocks_.at(portion.block).layers);
  };
}

void RollingBand::paint_missing(const FrameTable& table, const Window& band, Parallel& parallel) {
  std::vector<Portion> portions;
  const int lowest = block_of(band.first), highest = block_of(band.last);
  // More than there are threads, so that they end together.
  const int count = 4 * parallel.width();
  for (int block = lowest; block <= highest; ++block)
    add_portions(block, strips_left(block), count, portions);
  if (!portions.empty()) parallel.for_each(static_cast<int>(portions.size()), painter_of(table, portions));
}

// What remains of the blocks that come next over the steps that remain until they are reached. The first
// step, long as it is, takes what they are behind, so that those after it cost the same from the start.
std::vector<RollingBand::Portion> RollingBand::portions_ahead(const Window& before, const Window& band,
                                                              bool first, int threads) {
  const int lowest = block_of(band.first), highest = block_of(band.last);
  const int up = band.last - before.last, down = before.first - band.first;
  const int count = up > 0 && down > 0 ? (threads + 1) / 2 : threads;
  std::vector<Portion> portions;
  const auto ahead = [&](int block, int moved, int until_reached) {
    if (moved <= 0) return;
    const int steps = until_reached / moved + 1, left = strips_left(block);
    const int strips = first ? left - strips_ * until_reached / block_layers : (left + steps - 1) / steps;
    add_portions(block, strips, count, portions);
  };
  ahead(highest + 1, up, (highest + 1) * block_layers - 1 - band.last);
  ahead(lowest - 1, down, band.first - lowest * block_layers);
  return portions;
}

}  // namespace sonoband
