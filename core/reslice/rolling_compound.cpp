// How a rolling band's layers become its picture: kept maxima of runs, running counts and sums.
#include <algorithm>
#include <limits>

#include "core/reslice/layer_kernels.h"
#include "core/reslice/rolling_band.h"

namespace sonoband {
namespace {

constexpr int strip_rows = 16;  // by one thread at a time
// Runs made in one step: a drag after a band has grown would have to make all of the new layers' at once.
constexpr int most_builds = 12;

}  // namespace

RollingBand::Layer RollingBand::layer(int index) const {
  const int block = block_of(index);
  return {&blocks_.at(block).layers, index - block * block_layers};
}

Pixels RollingBand::take_run() {
  if (spare_runs_.empty()) return Pixels::unset(plane_.width, plane_.height);
  Pixels pixels = std::move(spare_runs_.back());
  spare_runs_.pop_back();
  return pixels;
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

// How many runs must be made for this one.
int RollingBand::unbuilt(const Run& run) const {
  if (run.level == 0 || runs_.contains(run)) return 0;
  return 1 + unbuilt({run.level - 1, run.first}) +
         unbuilt({run.level - 1, run.first + (1 << (run.level - 1))});
}

// Appends what a run is folded from: itself, or its parts while it needs more runs than there is room for.
void RollingBand::add_parts(const Run& run, int& room, std::vector<Run>& to_build, std::vector<Run>& parts) {
  const int builds = unbuilt(run);
  if (builds <= room) {
    room -= builds;
    need(run, to_build);
    parts.push_back(run);
    return;
  }
  add_parts({run.level - 1, run.first}, room, to_build, parts);
  add_parts({run.level - 1, run.first + (1 << (run.level - 1))}, room, to_build, parts);
}

void RollingBand::forget_nested() {
  for (Nested& n : nested_) give_back(std::move(n.extremes));
  nested_.clear();
}

// Leaves the nested pictures that lie within the band, adds an empty one of a band that has grown from
// `before`, and returns the band of the greatest of the others.
RollingBand::Window RollingBand::keep_nested(const Window& band, const Window& before) {
  while (!nested_.empty() && !band.holds(nested_.back().band)) {
    give_back(std::move(nested_.back().extremes));
    nested_.pop_back();
  }
  const Window inner = nested_.empty() ? Window{} : nested_.back().band;
  if (before.empty() || before == band || !band.holds(before) || inner == band) return inner;
  if (nested_.size() == most_nested) {
    give_back(std::move(nested_.front().extremes));
    nested_.erase(nested_.begin());
  }
  nested_.push_back({band, take_run()});
  return inner;
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
    marks.back().layers = static_cast<std::uint16_t>(marks.back().layers | LayerBlock::bits(l.index, 1));
  }
  return marks;
}

// Which layers come and go, and what is to be folded; makes room for it.
RollingBand::Step RollingBand::next_step(const Window& band) {
  const bool mean = settings_.compounding == Compounding::mean;
  Step step;

  // Layers that come and go since the last picture, or all of them where that is less.
  std::vector<int> come, gone;
  for (int i = counted_.first; i <= counted_.last; ++i)
    if (!band.holds(i)) gone.push_back(i);
  for (int i = band.first; i <= band.last; ++i)
    if (!counted_.holds(i)) come.push_back(i);
  const auto layers = static_cast<std::size_t>(band.last - band.first) + 1;
  const bool anew = counted_.empty() || (mean && !summed_) || come.size() + gone.size() > layers;
  if (anew) {
    counts_ = ImageBuffer<std::uint16_t>(plane_.width, plane_.height);
    sums_ = mean ? ImageBuffer<std::uint32_t>(plane_.width, plane_.height) : ImageBuffer<std::uint32_t>();
    gone.clear();
    come.clear();
    for (int i = band.first; i <= band.last; ++i) come.push_back(i);
    summed_ = mean;
  }
  const Window before = counted_;
  counted_ = band;
  summed_ = summed_ && mean;
  step.marks_come = marks_of(come);
  step.marks_gone = marks_of(gone);
  if (mean) {
    for (const int i : come) step.values_come.push_back(pixels_of({0, i}));
    for (const int i : gone) step.values_gone.push_back(pixels_of({0, i}));
    return step;
  }

  // Extremes: of a band within this one, and of the layers beside that.
  std::vector<Run> runs, to_build;
  const Window inner = keep_nested(band, before);
  if (!nested_.empty() && nested_.back().band != inner) step.grown = &nested_.back().extremes;
  int room = anew ? std::numeric_limits<int>::max() : most_builds;
  const auto add = [&](const Window& part) {
    for (const Run& run : runs_of(part)) add_parts(run, room, to_build, runs);
  };
  if (inner.empty()) {
    add(band);
  } else {
    add({band.first, inner.first - 1});
    add({inner.last + 1, band.last});
  }
  for (const Run& run : to_build) {
    const int half = 1 << (run.level - 1);
    step.builds.push_back({pixels_of({run.level - 1, run.first}),
                           pixels_of({run.level - 1, run.first + half}), &runs_.at(run)});
  }
  for (const Run& run : runs) step.parts.push_back(pixels_of(run));
  if (!inner.empty())
    step.parts.push_back(nested_[nested_.size() - (step.grown != nullptr ? 2 : 1)].extremes.view());
  return step;
}

void RollingBand::compound_row(const Step& step, int y, BandImage& image) {
  const LayerKernels& kernels = layer_kernels();
  const int width = plane_.width;
  const bool minimum = settings_.compounding == Compounding::minimum;
  for (const Build& build : step.builds) {
    const std::uint8_t* halves[2] = {build.first.row(y), build.second.row(y)};
    kernels.fold(halves, 2, minimum, width, build.both->view().row(y));
  }
  std::uint16_t* counts = counts_.view().row(y);
  const auto count = [&](const Marks& m, bool add) {
    kernels.count(m.block->has_data.view().row(y), m.layers, add, width, counts);
  };
  for (const Marks& m : step.marks_come) count(m, true);
  for (const Marks& m : step.marks_gone) count(m, false);
  std::uint8_t* pixels = image.pixels.view().row(y);
  if (settings_.compounding == Compounding::mean) {
    std::uint32_t* sums = sums_.view().row(y);
    for (const ConstPixels& v : step.values_come) kernels.sum(v.row(y), true, width, sums);
    for (const ConstPixels& v : step.values_gone) kernels.sum(v.row(y), false, width, sums);
    kernels.mean(sums, counts, width, pixels);
  } else {
    std::vector<const std::uint8_t*> rows;
    for (const ConstPixels& part : step.parts) rows.push_back(part.row(y));
    kernels.fold(rows.data(), static_cast<int>(rows.size()), minimum, width, pixels);
    if (step.grown != nullptr) std::copy_n(pixels, width, step.grown->view().row(y));
    if (minimum) kernels.blank(counts, width, pixels);
  }
  std::copy_n(counts, width, image.coverage.view().row(y));
}

BandImage RollingBand::compound(const Window& band, Parallel& parallel, int portions,
                                const std::function<void(int)>& paint_portion) {
  const int width = plane_.width, height = plane_.height;
  const Step step = next_step(band);
  BandImage image{Pixels::unset(width, height), ImageBuffer<std::uint16_t>::unset(width, height),
                  PixelKind::grey};
  // Portions first: strips are short, so that threads end together.
  const int strips = (height + strip_rows - 1) / strip_rows;
  parallel.for_each(portions + strips, [&](int i) {
    if (i < portions) {
      paint_portion(i);
      return;
    }
    const int first = (i - portions) * strip_rows;
    for (int y = first; y < std::min(first + strip_rows, height); ++y) compound_row(step, y, image);
  });
  return image;
}

}  // namespace sonoband
