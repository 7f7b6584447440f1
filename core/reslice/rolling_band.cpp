#include "core/reslice/rolling_band.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/layer_kernels.h"

namespace sonoband {
namespace {

constexpr int strip_rows = 16;  // compounded by one thread at a time

bool same_picture(const ReslicePlane& a, const ReslicePlane& b) {
  // Axes that differ by less turn a plane of 1000 pixels by less than a thousandth of a pixel.
  constexpr double turned = 1e-6;
  return (a.right.v - b.right.v).norm() < turned && (a.down.v - b.down.v).norm() < turned &&
         a.width == b.width && a.height == b.height && a.pixel_mm == b.pixel_mm;
}

std::uint8_t missing_of(Compounding how) {
  return how == Compounding::minimum ? 255 : 0;
}

}  // namespace

void RollingBand::clear() {
  begun_ = false;
  layers_.clear();
  runs_.clear();
  counted_ = {};
  layers_painted_ = 0;
}

std::size_t RollingBand::bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(std::max(plane_.width, 0)) * std::max(plane_.height, 0);
  return pixels * (2 * layers_.size() + runs_.size() + (layers_.empty() ? 0 : 6));
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
  clear();
  begun_ = true;
  plane_ = plane;
  settings_ = settings;
  frames_ = sweep.view().frames.size();
  offset_ = 0;
}

BandImage RollingBand::render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                              Parallel& parallel) {
  const PixelKind kind =
      sweep.view().frames.empty() ? PixelKind::grey : sweep.view().frames.front()->bscan.kind;
  if (plane.width <= 0 || plane.height <= 0 ||
      (kind == PixelKind::doppler && settings.compounding == Compounding::mean))
    return render_planar(sweep, plane, settings, parallel);
  int offset = 0;
  const bool follow = follows(sweep, plane, settings, offset);
  const bool still = offset == offset_ && settings.band.layers() == settings_.band.layers();
  if (!follow || (layers_.empty() && still)) {
    begin(sweep, plane, settings);
    return render_planar(sweep, plane, settings, parallel);
  }
  if (missing_ != missing_of(settings.compounding)) {
    // Extremes of the other kind; the layers' gaps are filled anew as they are marked again.
    runs_.clear();
    missing_ = missing_of(settings.compounding);
    for (auto& [index, layer] : layers_)
      for (int y = 0; y < plane.height; ++y) {
        std::uint8_t* values = layer.pixels.view().row(y);
        const std::uint8_t* has = layer.has_data.view().row(y);
        for (int x = 0; x < plane.width; ++x)
          values[x] = static_cast<std::uint8_t>((values[x] & has[x]) | (missing_ & ~has[x]));
      }
  }
  settings_ = settings;
  offset_ = offset;
  const int side = (settings.band.layers() - 1) / 2;
  const Window band{offset - side, offset + side};
  forget_far(band);
  paint_missing(sweep, band, parallel);
  BandImage image = compound(band, parallel);
  image.kind = kind;
  image.frames_left_out = left_out_;
  return image;
}

// Layers farther from the band than a quarter of its thickness go; what is nearer stays for a drag that turns
// back.
void RollingBand::forget_far(const Window& band) {
  const int room = (band.last - band.first + 1) / 4 + 8;
  const Window kept{band.first - room, band.last + room};
  // What is counted must be at hand to be taken off.
  if (!counted_.empty() && (counted_.first < kept.first || counted_.last > kept.last)) counted_ = {};
  std::erase_if(layers_, [&](const auto& entry) { return !kept.holds(entry.first); });
  std::erase_if(runs_, [&](const auto& entry) {
    const Run& run = entry.first;
    return run.first < kept.first || run.first + (1 << run.level) - 1 > kept.last;
  });
}

void RollingBand::paint_missing(PreparedSweep& sweep, const Window& band, Parallel& parallel) {
  RenderSettings thin = settings_;
  thin.band.thickness_mm = 0;
  thin.compounding = Compounding::maximum;
  for (int i = band.first; i <= band.last; ++i) {
    if (layers_.contains(i)) continue;
    ReslicePlane plane = plane_;
    plane.origin = plane.origin + (i * settings_.band.step_mm) * plane_.normal();
    BandImage image = render_planar(sweep, plane, thin, parallel);
    left_out_ = image.frames_left_out;
    layers_.emplace(i, Layer{std::move(image.pixels), {}, std::move(image.coverage)});
    ++layers_painted_;
  }
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
  runs_.emplace(run, Pixels(plane_.width, plane_.height));
  to_build.push_back(run);
}

const Pixels& RollingBand::pixels_of(const Run& run) const {
  return run.level == 0 ? layers_.at(run.first).pixels : runs_.at(run);
}

BandImage RollingBand::compound(const Window& band, Parallel& parallel) {
  const int width = plane_.width, height = plane_.height;
  const Compounding how = settings_.compounding;
  const bool mean = how == Compounding::mean, minimum = how == Compounding::minimum;

  std::vector<Layer*> fresh;
  for (auto& [index, layer] : layers_) {
    if (layer.has_data.width() == width) continue;
    layer.has_data = Pixels(width, height);
    fresh.push_back(&layer);
  }
  // Layers that come and go since the last picture, or all of them where that is less.
  std::vector<const Layer*> come, gone;
  for (int i = counted_.first; i <= counted_.last; ++i)
    if (!band.holds(i)) gone.push_back(&layers_.at(i));
  for (int i = band.first; i <= band.last; ++i)
    if (!counted_.holds(i)) come.push_back(&layers_.at(i));
  const auto layers = static_cast<std::size_t>(band.last - band.first + 1);
  const bool anew = counted_.empty() || (mean && !summed_) || come.size() + gone.size() > layers;
  if (anew) {
    counts_ = ImageBuffer<std::uint16_t>(width, height);
    sums_ = mean ? ImageBuffer<std::uint32_t>(width, height) : ImageBuffer<std::uint32_t>();
    gone.clear();
    come.clear();
    for (int i = band.first; i <= band.last; ++i) come.push_back(&layers_.at(i));
    summed_ = mean;
  }
  counted_ = band;
  summed_ = summed_ && mean;

  const std::vector<Run> runs = mean ? std::vector<Run>() : runs_of(band);
  std::vector<Run> to_build;
  for (const Run& run : runs) need(run, to_build);
  struct Build {
    const Pixels *first, *second;
    Pixels* both;
  };
  std::vector<Build> builds;
  for (const Run& run : to_build) {
    const int half = 1 << (run.level - 1);
    builds.push_back({&pixels_of({run.level - 1, run.first}), &pixels_of({run.level - 1, run.first + half}),
                      &runs_.at(run)});
  }
  std::vector<const Pixels*> parts;
  for (const Run& run : runs) parts.push_back(&pixels_of(run));

  BandImage image{Pixels(width, height), ImageBuffer<std::uint16_t>(width, height), PixelKind::grey};
  const LayerKernels& kernels = layer_kernels();
  parallel.for_each((height + strip_rows - 1) / strip_rows, [&](int strip) {
    std::vector<const std::uint8_t*> rows(parts.size());
    for (int y = strip * strip_rows; y < std::min((strip + 1) * strip_rows, height); ++y) {
      for (Layer* layer : fresh)
        kernels.mark(layer->coverage.view().row(y), missing_, width, layer->has_data.view().row(y),
                     layer->pixels.view().row(y));
      for (const Build& build : builds) {
        const std::uint8_t* halves[2] = {build.first->view().row(y), build.second->view().row(y)};
        kernels.fold(halves, 2, minimum, width, build.both->view().row(y));
      }
      std::uint16_t* counts = counts_.view().row(y);
      std::uint32_t* sums = mean ? sums_.view().row(y) : nullptr;
      const auto count = [&](const Layer& layer, bool add) {
        kernels.count({layer.pixels.view().row(y), layer.has_data.view().row(y)}, add, width, counts, sums);
      };
      for (const Layer* layer : come) count(*layer, true);
      for (const Layer* layer : gone) count(*layer, false);
      std::uint8_t* pixels = image.pixels.view().row(y);
      if (mean) {
        kernels.mean(sums, counts, width, pixels);
      } else {
        for (std::size_t i = 0; i < parts.size(); ++i) rows[i] = parts[i]->view().row(y);
        kernels.fold(rows.data(), static_cast<int>(rows.size()), minimum, width, pixels);
        if (minimum) kernels.blank(counts, width, pixels);
      }
      std::copy_n(counts, width, image.coverage.view().row(y));
    }
  });
  for (Layer* layer : fresh) layer->coverage = {};
  return image;
}

}  // namespace sonoband
