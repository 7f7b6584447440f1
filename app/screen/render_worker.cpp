#include "app/screen/render_worker.h"

#include <algorithm>
#include <utility>

#include "app/workers.h"

namespace sonoband {
namespace {

constexpr int most_given_up = 2;  // in a row

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
    asked_at_ = SteadyClock::now();
    called_ = true;
    if (working_ && !answered_ && !finishes_) overtaken_ = true;
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

// Of a job's results the last is the full one. False: it is overtaken and nothing was shown.
bool RenderWorker::publish(RenderResult result, bool last) {
  {
    const std::lock_guard lock(mutex_);
    // What was overtaken while it worked may be half a picture.
    if (overtaken_) {
      if (last) ++counts_.given_up;
      return false;
    }
    const bool coarse = result.planar->coarse || (result.manifold && result.manifold->coarse);
    result.version = ++results_;
    result.waited_ms = waited_ms_;
    newest_ = std::make_shared<const RenderResult>(std::move(result));
    if (last) {
      ++counts_.done;
      answered_ = true;
    } else {
      ++(coarse ? counts_.coarse : counts_.early);
      finishes_ = given_up_ >= most_given_up;
      overtaken_ = !finishes_ && next_.has_value();
    }
  }
  if (finished_) finished_();
  return true;
}

void RenderWorker::tell(const RequestPainter& painter) {
  const std::lock_guard lock(mutex_);
  counts_.from_layers = painter.from_layers();
  counts_.layers_ms = painter.layers_ms();
  counts_.layer_bytes = painter.layer_bytes();
  counts_.turned_bytes = painter.turned_bytes();
}

void RenderWorker::answer(RequestPainter& painter, const RenderRequest& request) {
  PreparedSweep sweep(request.sweep.view, request.settings.gap);
  RenderResult result =
      painter.answer(request, sweep, [this](RenderResult some) { return publish(std::move(some), false); });
  tell(painter);
  if (!publish(result, true)) return;
  painter.keep(request, result);
  painter.get_ready(request, sweep, called_);
  tell(painter);
}

// Waits for it; layers and turned pictures that nobody asks for meanwhile are given back.
RenderRequest RenderWorker::next_request(RequestPainter& painter, const RenderLimits& limits, bool& ends) {
  std::unique_lock lock(mutex_);
  working_ = false;
  if (!next_) idle_.notify_all();
  const auto called = [&] { return ending_ || next_.has_value(); };
  const bool keeps = painter.layer_bytes() + painter.turned_bytes() > 0;
  if (keeps && !wake_.wait_for(lock, limits.layers_kept, called)) {
    painter.give_back();
    counts_.layer_bytes = counts_.turned_bytes = 0;
  }
  wake_.wait(lock, called);
  ends = ending_;
  if (ends) return {};
  RenderRequest request = std::move(*next_);
  next_.reset();
  waited_ms_ = std::chrono::duration<double, std::milli>(SteadyClock::now() - asked_at_).count();
  called_ = false;
  working_ = true;
  given_up_ = overtaken_ ? given_up_ + 1 : 0;
  finishes_ = given_up_ > 0;
  answered_ = false;
  overtaken_ = false;
  return request;
}

void RenderWorker::serve(const RenderLimits& limits) {
  Workers workers(threads_);
  Stoppable parallel(workers, overtaken_);
  RequestPainter painter({parallel, workers, overtaken_}, limits.layer_bytes, limits.turned_bytes);
  for (bool ends = false;;) {
    const RenderRequest request = next_request(painter, limits, ends);
    if (ends) return;
    answer(painter, request);
  }
}

}  // namespace sonoband
