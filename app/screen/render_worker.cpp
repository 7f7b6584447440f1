#include "app/screen/render_worker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/thread_time.h"
#include "app/workers.h"

namespace sonoband {
namespace {

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

ReslicePlane halved(const ReslicePlane& plane) {
  ReslicePlane out = plane;
  out.origin.v += 0.5 * plane.pixel_mm * (plane.right.v + plane.down.v);
  out.pixel_mm = 2 * plane.pixel_mm;
  out.width = std::max(1, plane.width / 2);
  out.height = std::max(1, plane.height / 2);
  return out;
}

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
  return a.sweep_version == b.sweep_version && a.coarse == b.coarse &&
         s.band.thickness_mm == t.band.thickness_mm && s.band.step_mm == t.band.step_mm &&
         s.compounding == t.compounding && s.interpolation == t.interpolation && s.gap.mm == t.gap.mm;
}

RenderSettings settings_of(const RenderRequest& job) {
  RenderSettings settings = job.settings;
  if (job.coarse) settings.band.step_mm *= 2;
  return settings;
}

using SteadyClock = std::chrono::steady_clock;
double ms_since(SteadyClock::time_point begun) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - begun).count();
}

}  // namespace

RenderWorker::RenderWorker(int threads, std::function<void()> finished)
    : threads_(std::max(1, threads)), finished_(std::move(finished)), thread_([this] { serve(); }) {}

RenderWorker::~RenderWorker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    overtaken_ = true;
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

std::shared_ptr<PlanarPicture> RenderWorker::paint(const RenderRequest& job, PreparedSweep& sweep,
                                                   Parallel& parallel) {
  const auto begun = SteadyClock::now();
  const Duration worked = thread_time();
  auto out = std::make_shared<PlanarPicture>();
  out->version = ++pictures_;
  out->coarse = job.coarse;
  out->plane = job.coarse ? halved(job.plane) : job.plane;
  out->layers = settings_of(job).band.layers();
  out->band = render_planar(sweep, out->plane, settings_of(job), parallel, &overtaken_);
  out->ms = ms_since(begun);
  out->thread_ms = seconds(thread_time() - worked) * 1e3;
  return out;
}

std::shared_ptr<ManifoldPicture> RenderWorker::unroll(const RenderRequest& job, PreparedSweep& sweep,
                                                      Flow& kept, Parallel& parallel) {
  const auto begun = SteadyClock::now();
  const RenderSettings settings = settings_of(job);
  ReslicePlane plane = job.curve_plane;
  if (job.coarse) plane.pixel_mm *= 2;
  const int layers = settings.band.layers();
  if (kept.curve_mm != job.curve_mm || kept.pixel_mm != plane.pixel_mm || kept.layers != layers) {
    CurveSettings as_drawn;
    as_drawn.pixel_mm = plane.pixel_mm;
    as_drawn.smooth_px = 0;  // the stroke was smoothed as it was drawn
    CurveResult made = make_curve(job.curve_mm, as_drawn);
    if (made.fault != CurveFault::none) return nullptr;
    CurveFlow flow = band_flow(made.curve, plane, settings.band, FlowMethod::exact, parallel);
    if (overtaken_) return nullptr;
    kept = {job.curve_mm, plane.pixel_mm, layers, std::move(made.curve), std::move(flow)};
  }
  auto out = std::make_shared<ManifoldPicture>();
  out->version = ++pictures_;
  const LineBundle lines = manifold_lines(plane, kept.curve, kept.flow, job.reach_mm, settings.band);
  out->band = transposed(render_lines(sweep, lines, settings, parallel, &overtaken_));
  out->coarse = job.coarse;
  out->pixel_mm = plane.pixel_mm;
  out->length_mm = length_mm(kept.curve);
  out->layers = layers;
  out->thickness_mm = settings.band.thickness_mm;
  if (layers > 1) {
    out->up = kept.flow.layers.back().front;
    out->down = kept.flow.layers.front().front;
    out->smeared = stretches(smeared_rows(kept.flow, layers / 2), plane.pixel_mm);
  }
  out->ms = ms_since(begun);
  return out;
}

std::shared_ptr<RenderResult> RenderWorker::render(const RenderRequest& job, Kept& kept, Parallel& parallel) {
  PreparedSweep sweep(job.sweep.view, job.settings.gap);
  auto result = std::make_shared<RenderResult>();
  result->sweep_version = job.sweep_version;
  const bool same = same_look(job, kept.done);
  result->planar = same && same_plane(job.plane, kept.done.plane) ? kept.result.planar : nullptr;
  if (!result->planar) result->planar = paint(job, sweep, parallel);
  if (overtaken_ || job.curve_mm.size() < 2 || !(job.reach_mm > 0)) return result;
  const bool same_surface = same && same_plane(job.curve_plane, kept.done.curve_plane) &&
                            job.curve_mm == kept.done.curve_mm && job.reach_mm == kept.done.reach_mm;
  if (same_surface) result->manifold = kept.result.manifold;
  if (!result->manifold) result->manifold = unroll(job, sweep, kept.flow, parallel);
  return result;
}

void RenderWorker::serve() {
  Workers workers(threads_);
  Stoppable parallel(workers, overtaken_);
  Kept kept;
  for (;;) {
    RenderRequest job;
    {
      std::unique_lock lock(mutex_);
      working_ = false;
      if (!next_) idle_.notify_all();
      wake_.wait(lock, [&] { return ending_ || next_.has_value(); });
      if (ending_) return;
      job = std::move(*next_);
      next_.reset();
      working_ = true;
      finishes_ = overtaken_;  // the one before was given up
      overtaken_ = ending_;
    }
    auto result = render(job, kept, parallel);
    {
      const std::lock_guard lock(mutex_);
      // What was overtaken while it worked may be half a picture.
      if (overtaken_) {
        ++counts_.given_up;
        continue;
      }
      result->version = ++counts_.done;
      newest_ = result;
    }
    kept.result = *result;
    kept.done = std::move(job);
    kept.done.sweep = {};
    if (finished_) finished_();
  }
}

}  // namespace sonoband
