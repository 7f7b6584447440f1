#include "app/screen/render_worker.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/workers.h"
#include "core/manifold/flow.h"

namespace sonoband {
namespace {

// Runs what is left of a job as nothing once it is overtaken. The picture is then rubbish and is thrown away.
class Stoppable final : public Parallel {
 public:
  Stoppable(Parallel& inner, const std::atomic<bool>& stop) : inner_(inner), stop_(stop) {}
  int width() const override { return inner_.width(); }
  void for_each(int count, const std::function<void(int)>& body) override {
    inner_.for_each(count, [&](int i) {
      if (!stop_.load(std::memory_order_relaxed)) body(i);
    });
  }

 private:
  Parallel& inner_;
  const std::atomic<bool>& stop_;
};

ReslicePlane halved(const ReslicePlane& plane) {
  ReslicePlane out = plane;
  out.origin.v += 0.5 * plane.pixel_mm * (plane.right.v + plane.down.v);
  out.pixel_mm = 2 * plane.pixel_mm;
  out.width = std::max(1, plane.width / 2);
  out.height = std::max(1, plane.height / 2);
  return out;
}

std::vector<Eigen::Vector2d> joined(const FlowLayer& layer) {
  std::vector<Eigen::Vector2d> all;
  for (const PlaneLine& run : layer.front) all.insert(all.end(), run.begin(), run.end());
  return all;
}

// Where neighbouring rulings of an outermost layer stand closer than a quarter of their distance on the
// curve, they show the same pixels: the paper's smearing.
std::vector<Stretch> smears(const CurveFlow& flow, double spacing_mm) {
  const int rulings = static_cast<int>(flow.rulings.size());
  std::vector<Stretch> found;
  constexpr double squeezed = 0.25;
  const auto smeared = [&](int r) {
    for (const FlowLayer* layer : {&flow.layers.front(), &flow.layers.back()}) {
      if (layer->k == 0 || !layer->feet[r] || !layer->feet[r + 1]) continue;
      if ((*layer->feet[r + 1] - *layer->feet[r]).norm() < squeezed * spacing_mm) return true;
    }
    return false;
  };
  for (int r = 0; r + 1 < rulings; ++r) {
    if (!smeared(r)) continue;
    const double from = r * spacing_mm;
    if (!found.empty() && from - found.back().to_mm < 2 * spacing_mm) {
      found.back().to_mm = from + spacing_mm;
    } else {
      found.push_back({from, from + spacing_mm});
    }
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

}  // namespace

ManifoldPicture unroll(const SweepView& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                       const std::vector<Eigen::Vector2d>& curve_mm, double reach_mm, Parallel& parallel) {
  ManifoldPicture out;
  const double pixel_mm = settings.band.step_mm;
  CurveSettings as_drawn;
  as_drawn.pixel_mm = pixel_mm;
  as_drawn.smooth_px = 0;  // the stroke was smoothed as it was drawn
  const CurveResult made = make_curve(curve_mm, as_drawn);
  if (made.fault != CurveFault::none || !(reach_mm > 0)) return out;
  FlowSettings how;
  how.step_mm = pixel_mm;
  how.layers = std::min(max_flow_layers, (settings.band.layers() - 1) / 2);
  how.ruling_mm = pixel_mm;
  const CurveFlow flow = flow_curve(made.curve, how, parallel);
  const int rows = static_cast<int>(flow.rulings.size());
  if (rows == 0) return out;

  LineBundle bundle;
  bundle.rows = rows;
  bundle.layers = static_cast<int>(flow.layers.size());
  bundle.samples = 2 * static_cast<int>(std::lround(reach_mm / pixel_mm)) + 1;
  const Eigen::Vector3d normal = plane.normal().v;
  bundle.step.v = pixel_mm * normal;
  const Eigen::Vector3d first = -0.5 * (bundle.samples - 1) * bundle.step.v;
  bundle.starts.resize(static_cast<std::size_t>(rows) * bundle.layers);
  bundle.present.resize(bundle.starts.size());
  for (int l = 0; l < bundle.layers; ++l) {
    for (int r = 0; r < rows; ++r) {
      const std::size_t at = static_cast<std::size_t>(r) * bundle.layers + l;
      const auto& foot = flow.layers[l].feet[r];
      bundle.present[at] = foot ? 1 : 0;
      if (foot)
        bundle.starts[at].v = plane.origin.v + foot->x() * plane.right.v + foot->y() * plane.down.v + first;
    }
  }
  out.band = transposed(render_lines(sweep, bundle, settings, parallel));
  out.pixel_mm = pixel_mm;
  out.length_mm = length_mm(made.curve);
  out.layers = bundle.layers;
  out.thickness_mm = settings.band.thickness_mm;
  if (how.layers > 0) {
    out.upwind = joined(flow.layers.back());
    out.downwind = joined(flow.layers.front());
    out.smeared = smears(flow, rows > 1 ? out.length_mm / (rows - 1) : out.length_mm);
  }
  return out;
}

RenderWorker::RenderWorker(int threads) : threads_(std::max(1, threads)), thread_([this] { serve(); }) {}

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
    overtaken_ = true;
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

RenderWorker::Counts RenderWorker::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void RenderWorker::serve() {
  Workers workers(threads_);
  Stoppable parallel(workers, overtaken_);
  for (;;) {
    RenderRequest job;
    {
      std::unique_lock lock(mutex_);
      working_ = false;
      wake_.wait(lock, [&] { return ending_ || next_.has_value(); });
      if (ending_) return;
      job = std::move(*next_);
      next_.reset();
      working_ = true;
      overtaken_ = false;
    }
    auto result = std::make_shared<RenderResult>();
    result->coarse = job.coarse;
    result->plane = job.coarse ? halved(job.plane) : job.plane;
    if (job.coarse) job.settings.band.step_mm *= 2;
    const auto begun = std::chrono::steady_clock::now();
    result->band = render_planar(job.sweep.view, result->plane, job.settings, parallel);
    result->band_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
    if (!overtaken_ && job.curve_mm.size() > 1) {
      result->manifold =
          unroll(job.sweep.view, job.plane, job.settings, job.curve_mm, job.reach_mm, parallel);
    }
    const std::lock_guard lock(mutex_);
    // What was overtaken while it worked may be half a picture.
    if (overtaken_) {
      ++counts_.given_up;
    } else {
      result->version = ++counts_.done;
      newest_ = std::move(result);
    }
  }
}

}  // namespace sonoband
