#include "core/reslice/rolling_band.h"

#include <algorithm>
#include <cmath>

#include "core/reslice/compound.h"
#include "core/reslice/patch.h"

namespace sonoband {
namespace {

constexpr int strip_rows = 16;  // painted by one thread at a time

bool same_picture(const ReslicePlane& a, const ReslicePlane& b) {
  // Axes that differ by less turn a plane of 1000 pixels by less than a thousandth of a pixel.
  constexpr double turned = 1e-6;
  return (a.right.v - b.right.v).norm() < turned && (a.down.v - b.down.v).norm() < turned &&
         a.width == b.width && a.height == b.height && a.pixel_mm == b.pixel_mm;
}

}  // namespace

void RollingBand::clear() {
  layers_.clear();
  layers_painted_ = 0;
}

RollingBand::Step RollingBand::step_to(const PreparedSweep& sweep, const ReslicePlane& plane,
                                       const RenderSettings& settings) const {
  if (layers_.empty() || sweep.view().frames.size() != frames_ || !same_picture(plane, plane_) ||
      settings.interpolation != settings_.interpolation || settings.band.step_mm != settings_.band.step_mm) {
    return {};
  }
  constexpr double off_steps = 1e-3;
  const Eigen::Vector3d moved = (plane.origin.v - plane_.origin.v) / settings.band.step_mm;
  const double along = moved.dot(plane_.normal().v);
  const double whole = std::round(along);
  if ((moved - whole * plane_.normal().v).norm() > off_steps) return {};
  const int offset = static_cast<int>(whole), side = (settings.band.layers() - 1) / 2;
  // Far away nothing is kept.
  const int last = first_ + static_cast<int>(layers_.size()) - 1;
  const bool meets = offset + side >= first_ - 1 && offset - side <= last + 1;
  return {meets, offset};
}

RollingBand::Layer RollingBand::paint(PreparedSweep& sweep, int index, Parallel& parallel) {
  ReslicePlane plane = plane_;
  plane.origin = plane.origin + (index * settings_.band.step_mm) * plane_.normal();
  RenderSettings thin = settings_;
  thin.band.thickness_mm = 0;
  thin.compounding = Compounding::maximum;
  BandImage image = render_planar(sweep, plane, thin, parallel);
  Layer layer{std::move(image.pixels), Pixels(plane.width, plane.height)};
  for (int y = 0; y < plane.height; ++y) {
    const std::uint16_t* covered = image.coverage.view().row(y);
    std::uint8_t* has = layer.has_data.view().row(y);
    for (int x = 0; x < plane.width; ++x) has[x] = covered[x] != 0 ? 255 : 0;
  }
  ++layers_painted_;
  return layer;
}

BandImage RollingBand::render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                              Parallel& parallel) {
  const PixelKind kind =
      sweep.view().frames.empty() ? PixelKind::grey : sweep.view().frames.front()->bscan.kind;
  const int count = settings.band.layers();
  if (plane.width <= 0 || plane.height <= 0 ||
      (kind == PixelKind::doppler && settings.compounding == Compounding::mean))
    return render_planar(sweep, plane, settings, parallel);
  const int side = (count - 1) / 2;
  Step step = step_to(sweep, plane, settings);
  settings_ = settings;
  if (!step.fits) {
    clear();
    plane_ = plane;
    frames_ = sweep.view().frames.size();
    first_ = -side;
    step = {true, 0};
  }
  const int first = step.offset - side, last = step.offset + side;
  // A layer beyond the band stays for one thickness, in case the drag turns back.
  while (!layers_.empty() && first_ < first - count) {
    layers_.pop_front();
    ++first_;
  }
  while (!layers_.empty() && first_ + static_cast<int>(layers_.size()) - 1 > last + count) layers_.pop_back();
  if (layers_.empty()) first_ = first;
  while (first_ > first) layers_.push_front(paint(sweep, --first_, parallel));
  while (first_ + static_cast<int>(layers_.size()) - 1 < last)
    layers_.push_back(paint(sweep, first_ + static_cast<int>(layers_.size()), parallel));

  BandImage image{Pixels(plane.width, plane.height), ImageBuffer<std::uint16_t>(plane.width, plane.height),
                  kind};
  parallel.for_each((plane.height + strip_rows - 1) / strip_rows, [&](int strip) {
    std::vector<std::uint8_t> extreme(plane.width);
    std::vector<std::uint32_t> sum(plane.width);
    for (int y = strip * strip_rows; y < std::min((strip + 1) * strip_rows, plane.height); ++y) {
      const bool minimum = settings.compounding == Compounding::minimum;
      const bool mean = settings.compounding == Compounding::mean;
      std::fill(extreme.begin(), extreme.end(), minimum ? 255 : 0);
      std::fill(sum.begin(), sum.end(), 0);
      std::uint16_t* covered = image.coverage.view().row(y);
      for (int i = first; i <= last; ++i) {
        const Layer& layer = layers_[static_cast<std::size_t>(i - first_)];
        patch_kernels().stack(layer.pixels.view().row(y), layer.has_data.view().row(y), plane.width, minimum,
                              extreme.data(), mean ? sum.data() : nullptr, covered);
      }
      std::uint8_t* pixels = image.pixels.view().row(y);
      for (int x = 0; x < plane.width; ++x) {
        if (covered[x] != 0) pixels[x] = mean ? rounded_mean(sum[x], covered[x]) : extreme[x];
      }
    }
  });
  return image;
}

}  // namespace sonoband
