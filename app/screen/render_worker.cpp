#include "app/screen/render_worker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/thread_time.h"
#include "app/workers.h"
#include "core/reslice/progressive.h"

namespace sonoband {
namespace {

constexpr int coarse_factor = 2;  // an eighth of the samples

// Runs what is left of a job as nothing once it is overtaken. What comes of it is rubbish and is thrown away.
class Stoppable final : public Parallel {
 public:
  Stoppable(Parallel& inner, const StopFlag& stop) : inner_(inner), stop_(stop) {}
  int width() const override { return inner_.width(); }
  void for_each(int count, const std::function<void(int)>& body) override {
    inner_.for_each(count, [&](int i) {
      if (!stop_.load(std::memory_order_relaxed)) body(i);
    });
  }

 private:
  Parallel& inner_;
  const StopFlag& stop_;
};

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

bool same_plane(const ReslicePlane& a, const ReslicePlane& b) {
  return a.origin.v == b.origin.v && a.right.v == b.right.v && a.down.v == b.down.v && a.width == b.width &&
         a.height == b.height && a.pixel_mm == b.pixel_mm;
}

// Whatever matters to both pictures.
bool same_look(const RenderRequest& a, const RenderRequest& b) {
  const RenderSettings& s = a.settings;
  const RenderSettings& t = b.settings;
  return a.sweep_version == b.sweep_version && s.band.thickness_mm == t.band.thickness_mm &&
         s.band.step_mm == t.band.step_mm && s.compounding == t.compounding &&
         s.interpolation == t.interpolation && s.gap.mm == t.gap.mm;
}

bool same_surface(const RenderRequest& a, const RenderRequest& b) {
  return same_look(a, b) && same_plane(a.curve_plane, b.curve_plane) && a.curve_mm == b.curve_mm &&
         a.reach_mm == b.reach_mm;
}

// The next request will be a step from layers of this one.
bool drags(const RenderRequest& from, const RenderRequest& to) {
  if (to.drag_ahead) return true;
  return to.moving && to.sweep_version == from.sweep_version && moved_along_normal(from.plane, to.plane) &&
         (!same_plane(from.plane, to.plane) ||
          from.settings.band.thickness_mm != to.settings.band.thickness_mm);
}

RenderSettings settings_of(const RenderRequest& job) {
  RenderSettings settings = job.settings;
  settings.thin_dense_frames = job.moving;
  return settings;
}

RenderSettings layer_settings_of(const RenderRequest& job) {
  RenderSettings settings = job.settings;
  settings.thin_dense_frames = true;
  return settings;
}

double samples_of(const RenderRequest& job) {
  return static_cast<double>(job.plane.width) * job.plane.height * job.settings.band.layers();
}

using SteadyClock = std::chrono::steady_clock;
double ms_since(SteadyClock::time_point begun) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - begun).count();
}

}  // namespace

RenderWorker::RenderWorker(int threads, std::function<void()> finished, const RenderLimits& limits)
    : threads_(std::max(1, threads)),
      finished_(std::move(finished)),
      thread_([this, limits] { serve(limits); }) {}

RenderWorker::~RenderWorker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    overtaken_ = true;
    called_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void RenderWorker::ask(RenderRequest request) {
  {
    const std::lock_guard lock(mutex_);
    ++counts_.asked;
    if (next_) ++counts_.given_up;
    next_ = std::move(request);
    called_ = true;
    if (working_ && !finishes_) overtaken_ = true;
  }
  wake_.notify_all();
}

std::shared_ptr<const RenderResult> RenderWorker::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

bool RenderWorker::busy() const {
  const std::lock_guard lock(mutex_);
  return working_ || next_.has_value();
}

void RenderWorker::wait() const {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [&] { return !working_ && !next_; });
}

RenderWorker::Counts RenderWorker::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::shared_ptr<PlanarPicture> RenderWorker::picture_for(const Job& job) {
  auto out = std::make_shared<PlanarPicture>();
  out->version = ++pictures_;
  out->plane = job.request.plane;
  out->layers = job.request.settings.band.layers();
  return out;
}

// A step of a drag, where its layers are ready; else null.
std::shared_ptr<PlanarPicture> RenderWorker::from_layers(Job& job) {
  const RenderRequest& request = job.request;
  if (!request.moving) return nullptr;
  const auto begun = SteadyClock::now();
  const Duration worked = thread_time();
  const double pace = job.kept.ms_per_sample[static_cast<std::size_t>(request.settings.interpolation)];
  auto band = job.kept.layers.render(job.sweep, request.plane, layer_settings_of(request),
                                     pace * samples_of(request), job.workers);
  if (!band) return nullptr;
  auto out = picture_for(job);
  out->band = std::move(*band);
  out->exact = false;
  out->ms = ms_since(begun);
  out->thread_ms = seconds(thread_time() - worked) * 1e3;
  const std::lock_guard lock(mutex_);
  ++counts_.from_layers;
  return out;
}

// By render_planar; a coarse picture first where the full one takes longer than the budget.
std::shared_ptr<PlanarPicture> RenderWorker::paint(Job& job) {
  const RenderRequest& request = job.request;
  const auto begun = SteadyClock::now();
  const Duration worked = thread_time();
  auto out = picture_for(job);
  double& pace = job.kept.ms_per_sample[static_cast<std::size_t>(request.settings.interpolation)];
  const double budget_ms = request.moving ? request.budget_ms : 0;
  const bool in_time = pace > 0 && pace * samples_of(request) <= budget_ms;
  TimeBudget budget;
  budget.factor = budget_ms > 0 && !in_time ? coarse_factor : 1;
  budget.spent = [&] { return ms_since(begun) > budget_ms; };
  render_progressively(job.sweep, request.plane, settings_of(request), budget, job.parallel, &overtaken_,
                       [&](BandImage band, int factor) {
                         if (factor == 1) {
                           out->band = std::move(band);
                         } else {
                           show_coarse(job, std::move(band), ms_since(begun),
                                       seconds(thread_time() - worked) * 1e3);
                         }
                       });
  out->exact = out->band.frames_left_out == 0;
  out->ms = ms_since(begun);
  out->thread_ms = seconds(thread_time() - worked) * 1e3;
  if (!overtaken_ && samples_of(request) > 0) pace = out->ms / samples_of(request);
  return out;
}

void RenderWorker::show_coarse(Job& job, BandImage band, double ms, double thread_ms) {
  auto result = std::make_shared<RenderResult>();
  auto planar = picture_for(job);
  planar->band = std::move(band);
  planar->plane = coarse_plane(job.request.plane, coarse_factor);
  planar->layers = coarse_band(job.request.settings.band, coarse_factor).layers();
  planar->coarse = true;
  planar->exact = false;
  planar->ms = ms;
  planar->thread_ms = thread_ms;
  result->planar = std::move(planar);
  result->sweep_version = job.request.sweep_version;
  if (same_surface(job.request, job.kept.done)) {
    result->manifold = job.kept.result.manifold;
  } else {
    result->manifold = unroll(job, coarse_factor);
  }
  publish(std::move(result), false);
}

std::shared_ptr<const PlanarPicture> RenderWorker::planar(Job& job) {
  const Kept& kept = job.kept;
  if (kept.result.planar && same_look(job.request, kept.done) &&
      same_plane(job.request.plane, kept.done.plane) && (kept.result.planar->exact || job.request.moving))
    return kept.result.planar;
  if (auto step = from_layers(job)) return step;
  return paint(job);
}

// Null where the curve makes none.
std::shared_ptr<ManifoldPicture> RenderWorker::unroll(Job& job, int factor) {
  const RenderRequest& request = job.request;
  if (request.curve_mm.size() < 2 || !(request.reach_mm > 0)) return nullptr;
  const auto begun = SteadyClock::now();
  RenderSettings settings = settings_of(request);
  settings.band.step_mm *= factor;
  ReslicePlane plane = request.curve_plane;
  plane.pixel_mm *= factor;
  const int layers = settings.band.layers();
  Flow& flow = job.kept.flow;
  if (flow.curve_mm != request.curve_mm || flow.pixel_mm != plane.pixel_mm || flow.layers != layers) {
    CurveSettings as_drawn;
    as_drawn.pixel_mm = plane.pixel_mm;
    as_drawn.smooth_px = 0;  // the stroke was smoothed as it was drawn
    CurveResult made = make_curve(request.curve_mm, as_drawn);
    if (made.fault != CurveFault::none) return nullptr;
    CurveFlow flowed = band_flow(made.curve, plane, settings.band, FlowMethod::exact, job.parallel);
    if (overtaken_) return nullptr;
    flow = {request.curve_mm, plane.pixel_mm, layers, std::move(made.curve), std::move(flowed)};
  }
  auto out = std::make_shared<ManifoldPicture>();
  out->version = ++pictures_;
  const LineBundle lines = manifold_lines(plane, flow.curve, flow.flow, request.reach_mm, settings.band);
  out->band = transposed(render_lines(job.sweep, lines, settings, job.parallel, &overtaken_));
  out->coarse = factor > 1;
  out->exact = factor == 1 && out->band.frames_left_out == 0;
  out->pixel_mm = plane.pixel_mm;
  out->length_mm = length_mm(flow.curve);
  out->layers = layers;
  out->thickness_mm = settings.band.thickness_mm;
  if (layers > 1) {
    out->up = flow.flow.layers.back().front;
    out->down = flow.flow.layers.front().front;
    out->smeared = stretches(smeared_rows(flow.flow, layers / 2), plane.pixel_mm);
  }
  out->ms = ms_since(begun);
  return out;
}

std::shared_ptr<const ManifoldPicture> RenderWorker::manifold(
    Job& job, const std::shared_ptr<const PlanarPicture>& planar) {
  const RenderRequest& request = job.request;
  Kept& kept = job.kept;
  if (request.curve_mm.size() < 2 || !(request.reach_mm > 0)) return nullptr;
  if (kept.result.manifold && same_surface(request, kept.done) &&
      (kept.result.manifold->exact || request.moving))
    return kept.result.manifold;
  if (request.moving && request.budget_ms > 0 && kept.manifold_ms > request.budget_ms) {
    auto result = std::make_shared<RenderResult>();
    result->planar = planar;
    result->manifold = unroll(job, coarse_factor);
    result->sweep_version = request.sweep_version;
    if (!publish(std::move(result), false)) return nullptr;
  }
  auto full = unroll(job, 1);
  if (full && !overtaken_) kept.manifold_ms = full->ms;
  return full;
}

// Of a job's results the last is the full one. False: it is overtaken and nothing was shown.
bool RenderWorker::publish(std::shared_ptr<RenderResult> result, bool last) {
  {
    const std::lock_guard lock(mutex_);
    // What was overtaken while it worked may be half a picture.
    if (overtaken_) {
      if (last) ++counts_.given_up;
      return false;
    }
    result->version = ++results_;
    newest_ = std::move(result);
    if (last) {
      ++counts_.done;
    } else {
      ++counts_.coarse;
      finishes_ = false;
      overtaken_ = next_.has_value();
    }
  }
  if (finished_) finished_();
  return true;
}

void RenderWorker::get_layers_ready(Job& job) {
  const Duration worked = thread_time();
  const RenderRequest& request = job.request;
  job.kept.layers.get_ready(job.sweep, request.plane, layer_settings_of(request), job.workers, called_);
  tell_layers(job.kept.layers, seconds(thread_time() - worked) * 1e3);
}

void RenderWorker::tell_layers(const DragLayers& layers, double ms) {
  const std::lock_guard lock(mutex_);
  counts_.layers_ms += ms;
  counts_.layer_bytes = layers.bytes();
}

void RenderWorker::answer(Job& job) {
  Kept& kept = job.kept;
  kept.layers.follow(job.request.sweep_version, job.request.settings.gap);
  tell_layers(kept.layers, 0);
  auto result = std::make_shared<RenderResult>();
  result->sweep_version = job.request.sweep_version;
  result->planar = planar(job);
  if (!overtaken_) result->manifold = manifold(job, result->planar);
  if (!publish(result, true)) return;
  const bool dragged = drags(kept.done, job.request);
  kept.result = *result;
  kept.done = job.request;
  kept.done.sweep = {};
  if (dragged) get_layers_ready(job);
}

// Waits for it; layers that nobody asks for meanwhile are given back.
RenderRequest RenderWorker::next_request(Kept& kept, const RenderLimits& limits, bool& ends) {
  std::unique_lock lock(mutex_);
  working_ = false;
  if (!next_) idle_.notify_all();
  const auto called = [&] { return ending_ || next_.has_value(); };
  if (kept.layers.bytes() > 0 && !wake_.wait_for(lock, limits.layers_kept, called)) {
    kept.layers.give_back();
    counts_.layer_bytes = 0;
  }
  wake_.wait(lock, called);
  ends = ending_;
  if (ends) return {};
  RenderRequest request = std::move(*next_);
  next_.reset();
  called_ = false;
  working_ = true;
  finishes_ = overtaken_;  // the one before was given up
  overtaken_ = false;
  return request;
}

void RenderWorker::serve(const RenderLimits& limits) {
  Workers workers(threads_);
  Stoppable parallel(workers, overtaken_);
  Kept kept{{}, {}, {}, DragLayers(limits.layer_bytes), {}, 0};
  for (bool ends = false;;) {
    const RenderRequest request = next_request(kept, limits, ends);
    if (ends) return;
    Job job{request, PreparedSweep(request.sweep.view, request.settings.gap), parallel, workers, kept};
    answer(job);
  }
}

}  // namespace sonoband
