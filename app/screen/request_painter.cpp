#include "app/screen/request_painter.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/thread_time.h"
#include "core/reslice/progressive.h"

namespace sonoband {
namespace {

constexpr int coarse_factor = 2;  // an eighth of the samples

// Columns, neighbours of which are pixel_mm apart on the curve, as stretches of it.
std::vector<Stretch> stretches(const std::vector<std::uint8_t>& smeared, double pixel_mm) {
  std::vector<Stretch> found;
  for (std::size_t column = 0; column < smeared.size(); ++column) {
    if (smeared[column] == 0) continue;
    const double at = static_cast<double>(column) * pixel_mm;
    if (column == 0 || smeared[column - 1] == 0) found.push_back({at, at});
    found.back().to_mm = at;
  }
  return found;
}

BandImage transposed(const BandImage& in) {
  BandImage out;
  const int width = in.pixels.height();
  const int height = in.pixels.width();
  out.kind = in.kind;
  out.pixels = Pixels(width, height);
  out.coverage = ImageBuffer<std::uint16_t>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      out.pixels.view()(x, y) = in.pixels.view()(y, x);
      out.coverage.view()(x, y) = in.coverage.view()(y, x);
    }
  }
  return out;
}

RenderSettings settings_of(const RenderRequest& request) {
  RenderSettings settings = request.settings;
  settings.thin_dense_frames = request.moving;
  return settings;
}

RenderSettings layer_settings_of(const RenderRequest& request) {
  RenderSettings settings = request.settings;
  settings.thin_dense_frames = true;
  return settings;
}

using SteadyClock = std::chrono::steady_clock;
double ms_since(SteadyClock::time_point begun) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - begun).count();
}

}  // namespace

std::shared_ptr<PlanarPicture> RequestPainter::picture_for(const RenderRequest& request) {
  auto out = std::make_shared<PlanarPicture>();
  out->version = ++pictures_;
  out->plane = request.plane;
  out->layers = request.settings.band.layers();
  return out;
}

// A step of a drag, where its layers are ready; else null.
std::shared_ptr<PlanarPicture> RequestPainter::from_layers(const Job& job) {
  const RenderRequest& request = job.request;
  if (!request.moving) return nullptr;
  const auto begun = SteadyClock::now();
  const Duration worked = thread_time();
  double other_ms = pace(request) * samples_of(request);
  // What takes longer than the budget is coarse at first, and cheaper.
  if (request.budget_ms > 0) other_ms = std::min(other_ms, request.budget_ms);
  auto band = layers_.render(job.sweep, request.plane, layer_settings_of(request), other_ms, hands_.workers);
  if (!band) return nullptr;
  auto out = picture_for(request);
  out->band = std::move(*band);
  out->from_layers = true;
  out->exact = false;
  out->ms = ms_since(begun);
  out->thread_ms = seconds(thread_time() - worked) * 1e3;
  out->first_ms = out->thread_ms;
  ++from_layers_;
  return out;
}

// By render_planar; a coarse picture first where the full one takes longer than the budget: at once where
// that is known, else as soon as the budget is spent.
std::shared_ptr<PlanarPicture> RequestPainter::paint(const Job& job) {
  const RenderRequest& request = job.request;
  const auto begun = SteadyClock::now();
  const Duration worked = thread_time();
  auto out = picture_for(request);
  const double usual_ms = pace(request) * samples_of(request);
  const double budget_ms = request.moving ? request.budget_ms : 0;
  const bool known = usual_ms > 0;
  TimeBudget budget;
  budget.factor = budget_ms > 0 && !(known && usual_ms <= budget_ms) ? coarse_factor : 1;
  budget.spent = [&] { return known || ms_since(begun) > budget_ms; };
  render_progressively(job.sweep, request.plane, settings_of(request), budget, hands_.parallel,
                       &hands_.overtaken, [&](BandImage band, int factor) {
                         if (factor == 1) {
                           out->band = std::move(band);
                         } else {
                           out->first_ms = seconds(thread_time() - worked) * 1e3;
                           show_coarse(job, std::move(band), ms_since(begun), out->first_ms);
                         }
                       });
  out->exact = out->band.frames_left_out == 0;
  out->ms = ms_since(begun);
  out->thread_ms = seconds(thread_time() - worked) * 1e3;
  if (out->first_ms == 0) out->first_ms = out->thread_ms;
  if (!hands_.overtaken && samples_of(request) > 0) pace(request) = out->ms / samples_of(request);
  return out;
}

void RequestPainter::show_coarse(const Job& job, BandImage band, double ms, double thread_ms) {
  RenderResult result;
  auto planar = picture_for(job.request);
  planar->band = std::move(band);
  planar->plane = coarse_plane(job.request.plane, coarse_factor);
  planar->layers = coarse_band(job.request.settings.band, coarse_factor).layers();
  planar->coarse = true;
  planar->exact = false;
  planar->ms = ms;
  planar->thread_ms = planar->first_ms = thread_ms;
  result.planar = std::move(planar);
  result.sweep_id = job.request.sweep_id;
  result.sweep_version = job.request.sweep_version;
  if (has_surface(job.request))
    result.manifold = of_shown_sweep(job.request) ? seen_ : unroll(job, coarse_factor);
  show(job, std::move(result));
}

// The finger waits for this one alone: the manifold, which it may move as well, takes three times as long.
void RequestPainter::show_planar(const Job& job, const std::shared_ptr<const PlanarPicture>& planar) {
  const RenderRequest& request = job.request;
  const bool other_manifold = has_surface(request) && !keeps_manifold(request);
  if (!other_manifold || planar == result_.planar || !of_shown_sweep(request)) return;
  RenderResult result;
  result.planar = planar;
  result.manifold = seen_;
  result.sweep_id = request.sweep_id;
  result.sweep_version = request.sweep_version;
  show(job, std::move(result));
}

bool RequestPainter::show(const Job& job, RenderResult result) {
  auto manifold = result.manifold;
  if (!job.show(std::move(result))) return false;
  seen_ = std::move(manifold);
  return true;
}

// Pictures of one sweep are never shown beside those of another.
bool RequestPainter::of_shown_sweep(const RenderRequest& request) const {
  return result_.planar && request.sweep_version == done_.sweep_version;
}

bool RequestPainter::keeps_manifold(const RenderRequest& request) const {
  return result_.manifold && same_surface(request, done_) && (result_.manifold->exact || request.moving);
}

std::shared_ptr<const PlanarPicture> RequestPainter::planar(const Job& job) {
  if (result_.planar && same_look(job.request, done_) && same_plane(job.request.plane, done_.plane) &&
      (result_.planar->exact || job.request.moving))
    return result_.planar;
  if (auto step = from_layers(job)) return step;
  return paint(job);
}

// False: the curve makes none, or the job is overtaken.
bool RequestPainter::ready_flow(const RenderRequest& request, const ReslicePlane& plane, const Band& band) {
  const int layers = band.layers();
  if (flow_.curve_mm == request.curve_mm && flow_.pixel_mm == plane.pixel_mm && flow_.layers == layers)
    return true;
  CurveSettings as_drawn;
  as_drawn.pixel_mm = plane.pixel_mm;
  as_drawn.smooth_px = 0;  // the stroke was smoothed as it was drawn
  CurveResult made = make_curve(request.curve_mm, as_drawn);
  if (made.fault != CurveFault::none) return false;
  CurveFlow flowed = band_flow(made.curve, plane, band, FlowMethod::exact, hands_.parallel);
  if (hands_.overtaken) return false;
  flow_ = {request.curve_mm, plane.pixel_mm, layers, std::move(made.curve), std::move(flowed)};
  return true;
}

// Null where the curve makes none.
std::shared_ptr<ManifoldPicture> RequestPainter::unroll(const Job& job, int factor) {
  const RenderRequest& request = job.request;
  const auto begun = SteadyClock::now();
  RenderSettings settings = settings_of(request);
  settings.band.step_mm *= factor;
  ReslicePlane plane = request.curve_plane;
  plane.pixel_mm *= factor;
  const int layers = settings.band.layers();
  if (!ready_flow(request, plane, settings.band)) return nullptr;
  auto out = std::make_shared<ManifoldPicture>();
  out->version = ++pictures_;
  const LineBundle lines = manifold_lines(plane, flow_.curve, flow_.flow, request.reach_mm, settings.band);
  out->band = transposed(render_lines(job.sweep, lines, settings, hands_.parallel, &hands_.overtaken));
  out->coarse = factor > 1;
  out->exact = factor == 1 && out->band.frames_left_out == 0;
  out->pixel_mm = plane.pixel_mm;
  out->length_mm = length_mm(flow_.curve);
  out->layers = layers;
  out->thickness_mm = settings.band.thickness_mm;
  if (layers > 1) {
    out->up = flow_.flow.layers.back().front;
    out->down = flow_.flow.layers.front().front;
    out->smeared = stretches(smeared_rows(flow_.flow, layers / 2), plane.pixel_mm);
  }
  out->ms = ms_since(begun);
  return out;
}

std::shared_ptr<const ManifoldPicture> RequestPainter::manifold(
    const Job& job, const std::shared_ptr<const PlanarPicture>& planar) {
  const RenderRequest& request = job.request;
  if (!has_surface(request)) return nullptr;
  if (keeps_manifold(request)) return result_.manifold;
  if (request.moving && request.budget_ms > 0 && manifold_ms_ > request.budget_ms) {
    RenderResult coarse;
    coarse.planar = planar;
    coarse.manifold = unroll(job, coarse_factor);
    coarse.sweep_id = request.sweep_id;
    coarse.sweep_version = request.sweep_version;
    if (!show(job, std::move(coarse))) return nullptr;
  }
  auto full = unroll(job, 1);
  if (full && !hands_.overtaken) manifold_ms_ = full->ms;
  return full;
}

RenderResult RequestPainter::answer(const RenderRequest& request, PreparedSweep& sweep, const Show& show) {
  layers_.follow(request.sweep_version, request.settings.gap);
  if (request.sweep_version != turned_version_) turned_.clear();
  turned_version_ = request.sweep_version;
  sweep.use_turned(&turned_);
  const Job job{request, sweep, show};
  RenderResult result;
  result.sweep_id = request.sweep_id;
  result.sweep_version = request.sweep_version;
  result.planar = planar(job);
  if (!hands_.overtaken) show_planar(job, result.planar);
  if (!hands_.overtaken) result.manifold = manifold(job, result.planar);
  return result;
}

void RequestPainter::keep(const RenderRequest& request, const RenderResult& result) {
  dragged_ = drags(done_, request);
  // While a sweep grows each picture of it is another version.
  turned_parts_ = done_.sweep_version == request.sweep_version && result.planar->band.turned_parts;
  result_ = result;
  seen_ = result.manifold;
  done_ = request;
  done_.sweep = {};
}

void RequestPainter::give_back() {
  layers_.give_back();
  turned_.clear();
}

void RequestPainter::get_ready(const RenderRequest& request, PreparedSweep& sweep, const StopFlag& stop) {
  if (turned_parts_) turned_.extend(request.sweep.view, most_turned_bytes_, hands_.workers, &stop);
  if (!dragged_) return;
  const Duration worked = thread_time();
  layers_.get_ready(sweep, request.plane, layer_settings_of(request), hands_.workers, stop);
  layers_ms_ += seconds(thread_time() - worked) * 1e3;
}

}  // namespace sonoband
